#include "colmap_seapoint/io/files/content_hash.h"

#include <xxhash.h>

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <new>
#include <vector>

#include "colmap_seapoint/io/files/input_stream.h"

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
  InputStream file(path);
  std::vector<char> buffer(1 << 18);
  ContentHash hash;
  const auto buffer_bytes = static_cast<std::streamsize>(buffer.size());
  while (const std::streamsize size = file.rdbuf()->sgetn(buffer.data(), buffer_bytes)) {
    hash.Add(buffer.data(), static_cast<size_t>(size));
  }
  return hash.Text();
}

std::string HashSamplesOfFile(const std::filesystem::path& path) {
  constexpr uint64_t kBlockBytes = 1 << 20, kNumBlocks = 64;
  InputStream file(path);
  const uint64_t size = std::filesystem::file_size(path);
  ContentHash hash;
  hash.Add(&size, sizeof(size));
  const uint64_t whole_blocks = (size + kBlockBytes - 1) / kBlockBytes;
  const uint64_t num_blocks = std::min(whole_blocks, kNumBlocks);
  std::vector<char> block(kBlockBytes);
  for (uint64_t i = 0; i < num_blocks; ++i) {
    const uint64_t at =
        num_blocks == whole_blocks ? i * kBlockBytes : (size - kBlockBytes) / (kNumBlocks - 1) * i;
    file.seekg(static_cast<std::streamoff>(at));
    const std::streamsize read =
        file.rdbuf()->sgetn(block.data(), static_cast<std::streamsize>(block.size()));
    hash.Add(block.data(), static_cast<size_t>(read));
  }
  return hash.Text();
}

}  // namespace colmap_seapoint
