// Hashes of exact results: what guards the version numbers of extraction, matching and retrieval.
#pragma once

#include <cstdint>
#include <cstring>

namespace colmap_seapoint {

// FNV-1a, 64 bits, a byte at a time.
class GoldenHash {
 public:
  void AddBytes(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001B3u;
  }
  // Little-endian, so that the hash is the same on every machine.
  void Add(int64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      const auto low = static_cast<unsigned char>(static_cast<uint64_t>(value) >> (8 * byte));
      AddBytes(&low, 1);
    }
  }
  // All bits of a float that is computed with +, -, *, / and square roots alone.
  void AddExact(float value) {
    uint32_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    Add(bits);
  }
  uint64_t Value() const { return hash_; }

 private:
  uint64_t hash_ = 0xCBF29CE484222325u;
};

}  // namespace colmap_seapoint
