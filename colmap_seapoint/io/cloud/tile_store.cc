#include "colmap_seapoint/io/cloud/tile_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kBlockBytes = 1 << 14;

[[noreturn]] void Fail(const std::string& folder, const std::string& what, int error_number) {
  throw Error(
      folder, what + " (" + SystemText(error_number) + ")",
      "the clouds are sorted into temporary files there, of about their own size: free some "
      "space, or write to another disk");
}

}  // namespace

TileStore::TileStore(const std::filesystem::path& folder, int num_tiles, size_t record_bytes)
    : folder_(folder.empty() ? "." : folder.string()),
      record_bytes_(record_bytes),
      block_bytes_(std::max<size_t>(1, kBlockBytes / record_bytes) * record_bytes),
      tiles_(static_cast<size_t>(num_tiles)) {
  std::string name = folder_ + "/.seapoint_tiles_XXXXXX";
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) Fail(folder_, "no temporary file can be created in this folder", errno);
  unlink(name.c_str());
}

TileStore::~TileStore() {
  if (file_ >= 0) close(file_);
}

void TileStore::Append(int tile_idx, const void* records, size_t num_records) {
  Tile& tile = tiles_[static_cast<size_t>(tile_idx)];
  const char* begin = static_cast<const char*>(records);
  for (size_t left = num_records * record_bytes_; left > 0;) {
    const size_t part = std::min(left, block_bytes_ - tile.pending.size());
    tile.pending.insert(tile.pending.end(), begin, begin + part);
    begin += part;
    left -= part;
    if (tile.pending.size() == block_bytes_) WriteBlock(&tile);
  }
  tile.num_records += num_records;
}

void TileStore::WriteBlock(Tile* tile) {
  const std::vector<char>& bytes = tile->pending;
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        pwrite(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(size_ + done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) Fail(folder_, "a temporary file cannot be written", errno);
    done += static_cast<size_t>(written);
  }
  tile->blocks.push_back(size_);
  size_ += bytes.size();
  tile->pending.clear();
}

void TileStore::Finish() {
  for (Tile& tile : tiles_) {
    if (!tile.pending.empty()) WriteBlock(&tile);
    std::vector<char>().swap(tile.pending);
  }
}

void TileStore::ReadBytes(int tile_idx, void* data, size_t record_bytes) const {
  const Tile& tile = tiles_[static_cast<size_t>(tile_idx)];
  SEAPOINT_CHECK(record_bytes == record_bytes_ && tile.pending.empty());
  char* to = static_cast<char*>(data);
  size_t left = tile.num_records * record_bytes_;
  for (uint64_t block : tile.blocks) {
    size_t in_block = std::min(left, block_bytes_);
    left -= in_block;
    while (in_block > 0) {
      const ssize_t count = pread(file_, to, in_block, static_cast<off_t>(block));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) Fail(folder_, "a temporary file cannot be read", count < 0 ? errno : EIO);
      to += count;
      block += static_cast<uint64_t>(count);
      in_block -= static_cast<size_t>(count);
    }
  }
}

}  // namespace colmap_seapoint
