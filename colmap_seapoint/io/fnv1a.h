// 64-bit FNV-1a: tells whether bytes changed; no protection against intent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace colmap_seapoint {

class Fnv1a {
 public:
  void Add(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) state_ = (state_ ^ bytes[i]) * 0x100000001b3ull;
  }

  // 16 hex digits.
  std::string Hex() const {
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string text(16, '0');
    for (int i = 0; i < 16; ++i)
      text[static_cast<size_t>(i)] = kDigits[(state_ >> (60 - 4 * i)) & 15];
    return text;
  }

 private:
  uint64_t state_ = 0xcbf29ce484222325ull;
};

inline std::string HashBytes(const void* data, size_t size) {
  Fnv1a hash;
  hash.Add(data, size);
  return hash.Hex();
}

}  // namespace colmap_seapoint
