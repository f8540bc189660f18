#include "colmap_seapoint/io/files/content_hash.h"

#include <xxhash.h>

#include <cerrno>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNumDigits = 16;

std::string HexText(uint64_t hash) {
  char text[kNumDigits + 1];
  std::snprintf(text, sizeof(text), "%016" PRIx64, hash);
  return text;
}

std::string Named(XXH64_hash_t hash) { return "xxh3-" + HexText(hash); }

// Version 0.1 kept FNV-1a, without a name.
std::string HashOfVersion01(const void* data, size_t size) {
  uint64_t hash = 0xcbf29ce484222325ull;
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3ull;
  return HexText(hash);
}

}  // namespace

ContentHash::ContentHash() : state_(XXH3_createState()) {
  if (state_ == nullptr) throw std::bad_alloc();
  XXH3_64bits_reset(state_);
}

ContentHash::~ContentHash() { XXH3_freeState(state_); }

void ContentHash::Add(const void* data, size_t size) { XXH3_64bits_update(state_, data, size); }

std::string ContentHash::Text() const { return Named(XXH3_64bits_digest(state_)); }

std::string HashBytes(const void* data, size_t size) { return Named(XXH3_64bits(data, size)); }

bool IsHashOf(const std::string& hash, const void* data, size_t size) {
  return hash == (hash.size() == kNumDigits ? HashOfVersion01(data, size) : HashBytes(data, size));
}

std::string HashText(const std::string& text) { return HashBytes(text.data(), text.size()); }

std::string HashFile(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (file == nullptr) {
    throw Error(path.string(), std::string("cannot be read (") + std::strerror(errno) + ")",
                "check the path and the file's permissions");
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw Error(path.string(), "is no file", "give a file");
  }
  std::vector<unsigned char> buffer(1 << 18);
  ContentHash hash;
  while (const size_t size = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    hash.Add(buffer.data(), size);
  }
  if (std::ferror(file.get())) {
    throw Error(path.string(), "cannot be read to its end", "check the disk");
  }
  return hash.Text();
}

}  // namespace colmap_seapoint
