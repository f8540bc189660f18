// Records of one size, sorted into tiles on the disk: what of a huge cloud does not fit in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

namespace colmap_seapoint {

// One temporary file of blocks, each block of one tile. The file has no name from the start, so
// that nothing is left of it however the program ends. Memory: 16 kB a tile until Finish(), then 8
// bytes for every 16 kB written. Append and Finish on one thread; Read afterwards, on any.
// Throws Error naming the folder when it cannot be written (a full disk) or read.
class TileStore {
 public:
  TileStore(const std::filesystem::path& folder, int num_tiles, size_t record_bytes);
  ~TileStore();
  TileStore(const TileStore&) = delete;
  TileStore& operator=(const TileStore&) = delete;

  void Append(int tile, const void* records, size_t num_records = 1);
  void Finish();
  uint64_t NumRecords(int tile) const { return tiles_[static_cast<size_t>(tile)].num_records; }
  int NumTiles() const { return static_cast<int>(tiles_.size()); }
  // The tile's records in the order of Append.
  template <typename Record>
  std::vector<Record> Read(int tile) const {
    static_assert(std::is_trivially_copyable_v<Record>);
    std::vector<Record> records(NumRecords(tile));
    ReadBytes(tile, records.data(), sizeof(Record));
    return records;
  }

 private:
  struct Tile {
    uint64_t num_records = 0;
    std::vector<char> pending;
    std::vector<uint64_t> blocks;  // offsets
  };

  void WriteBlock(Tile* tile);
  void ReadBytes(int tile, void* data, size_t record_bytes) const;

  std::string folder_;
  size_t record_bytes_, block_bytes_;
  int file_ = -1;
  uint64_t size_ = 0;
  std::vector<Tile> tiles_;
};

}  // namespace colmap_seapoint
