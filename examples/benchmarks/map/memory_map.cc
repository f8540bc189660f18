#include "examples/benchmarks/map/memory_map.h"

#include <algorithm>

namespace colmap_seapoint {
namespace {

template <typename T>
void Paste(const Image<T>& tile, int x, int y, Image<T>* whole) {
  for (int row = 0; row < tile.height; ++row) {
    std::copy(tile.Row(row), tile.Row(row) + tile.Stride(),
              whole->Row(y + row) + static_cast<size_t>(x * tile.channels));
  }
}

}  // namespace

void MemoryMap::Begin(const MapFrame& frame, const MapGrid& grid) {
  frame_ = frame;
  grid_ = grid;
  whole_.relief = FloatImage(grid.width, grid.height, 1, kNoHeight);
  whole_.rgba = Image<uint8_t>(grid.width, grid.height, 4);
  whole_.source = Image<int32_t>(grid.width, grid.height, 1, kNoSource);
  whole_.surface = Image<uint8_t>(grid.width, grid.height);
}

void MemoryMap::Take(MapTile&& tile) {
  Paste(tile.relief, tile.x, tile.y, &whole_.relief);
  Paste(tile.rgba, tile.x, tile.y, &whole_.rgba);
  Paste(tile.source, tile.x, tile.y, &whole_.source);
  Paste(tile.surface, tile.x, tile.y, &whole_.surface);
}

}  // namespace colmap_seapoint
