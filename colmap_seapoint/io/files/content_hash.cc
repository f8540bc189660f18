#include "colmap_seapoint/io/files/content_hash.h"

#include <xxhash.h>

#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

std::string HexText(XXH64_hash_t hash) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, static_cast<uint64_t>(hash));
  return text;
}

}  // namespace

ContentHash::ContentHash() : state_(XXH3_createState()) {
  if (state_ == nullptr) throw std::bad_alloc();
  XXH3_64bits_reset(state_);
}

ContentHash::~ContentHash() { XXH3_freeState(state_); }

void ContentHash::Add(const void* data, size_t size) { XXH3_64bits_update(state_, data, size); }

std::string ContentHash::Hex() const { return HexText(XXH3_64bits_digest(state_)); }

std::string HashBytes(const void* data, size_t size) { return HexText(XXH3_64bits(data, size)); }

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
  return hash.Hex();
}

}  // namespace colmap_seapoint
