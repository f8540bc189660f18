// A grid without borders that keeps the tiles alone that something lies in: a diagonal transect
// takes no more memory than a straight one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace colmap_seapoint {

struct TileKey {
  int x = 0, y = 0;
  bool operator==(const TileKey& other) const { return x == other.x && y == other.y; }
  bool operator<(const TileKey& other) const { return y != other.y ? y < other.y : x < other.x; }
};

struct TileKeyHash {
  size_t operator()(const TileKey& key) const {
    uint64_t h =
        (static_cast<uint64_t>(static_cast<uint32_t>(key.x)) << 32) ^ static_cast<uint32_t>(key.y);
    h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9ULL;
    return static_cast<size_t>(h ^ (h >> 32));
  }
};

// Reading is safe from any number of threads, as is writing to cells of tiles that exist.
template <typename Cell>
class TiledGrid {
 public:
  static constexpr int kSide = 32;  // cells
  using Tile = std::array<Cell, static_cast<size_t>(kSide* kSide)>;

  static TileKey KeyOf(int x, int y) { return {x >> 5, y >> 5}; }
  static size_t IndexIn(int x, int y) {
    return static_cast<size_t>((y & (kSide - 1)) * kSide + (x & (kSide - 1)));
  }

  // Makes the tile where there is none.
  Cell& At(int x, int y) { return TileAt(KeyOf(x, y))[IndexIn(x, y)]; }
  Tile& TileAt(const TileKey& key) {
    const auto [place, is_new] = tiles_.try_emplace(key);
    if (is_new) place->second.fill(Cell());
    return place->second;
  }
  // nullptr where there is no tile.
  Cell* Find(int x, int y) {
    const auto place = tiles_.find(KeyOf(x, y));
    return place == tiles_.end() ? nullptr : &place->second[IndexIn(x, y)];
  }
  const Cell* Find(int x, int y) const {
    const auto place = tiles_.find(KeyOf(x, y));
    return place == tiles_.end() ? nullptr : &place->second[IndexIn(x, y)];
  }
  bool Holds(const TileKey& key) const { return tiles_.count(key) > 0; }
  Tile& ExistingTile(const TileKey& key) { return tiles_.at(key); }
  const Tile& ExistingTile(const TileKey& key) const { return tiles_.at(key); }

  // Row by row: the same order whatever the order in which tiles were made.
  std::vector<TileKey> Keys() const {
    std::vector<TileKey> keys;
    keys.reserve(tiles_.size());
    for (const auto& entry : tiles_) keys.push_back(entry.first);
    std::sort(keys.begin(), keys.end());
    return keys;
  }

  // visit(x, y, cell) for every cell of every tile, in the order of Keys().
  template <typename Visitor>
  void ForEach(const Visitor& visit) {
    for (const TileKey& key : Keys()) {
      Tile& tile = tiles_.at(key);
      for (int i = 0; i < kSide * kSide; ++i) {
        visit(key.x * kSide + i % kSide, key.y * kSide + i / kSide, tile[static_cast<size_t>(i)]);
      }
    }
  }
  template <typename Visitor>
  void ForEach(const Visitor& visit) const {
    const_cast<TiledGrid*>(this)->ForEach(
        [&](int x, int y, const Cell& cell) { visit(x, y, cell); });
  }

 private:
  std::unordered_map<TileKey, Tile, TileKeyHash> tiles_;
};

}  // namespace colmap_seapoint
