// A cloud of any size, sorted into the tiles of a map.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/io/cloud/tile_store.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"

namespace colmap_seapoint {

// Some 100,000 points, evenly over the file: enough to find plane and extent. Throws as CloudReader
// does, and Error for a cloud without points.
std::vector<Eigen::Vector3d> SampleCloud(const std::filesystem::path& path);

uint64_t NumPointsOf(const std::filesystem::path& path);

// Calls take(place) for every point of a cloud of ours from the `first` on.
void ReadPointsFrom(const std::filesystem::path& path, uint64_t first,
                    const std::function<void(const Eigen::Vector3d&)>& take);

struct TilePoint {
  float column = 0, row = 0;  // pixels from the tile's first corner
  float height = 0;           // above CloudTiles::BaseHeight()
  float weight = 1;           // its confidence, above 0
};

// How far around a tile its points are known too, pixels.
inline constexpr int kTileHalo = 64;

class CloudTiles {
 public:
  // Reads the cloud once. Points lie in a temporary file in `folder` (16 bytes each, some 1.3 of
  // each because of the halos); memory: 16 kB a tile and a number for every 16 x 16 pixels.
  // `is_wanted`, by tile: the others stay empty; empty: all are.
  CloudTiles(const std::filesystem::path& path, const Rigid3d& map_from_cloud, const MapGrid& grid,
             double base_height, const std::filesystem::path& folder,
             std::vector<uint8_t> is_wanted = {});

  // In the order of the file. From any thread.
  std::vector<TilePoint> Read(int tile_idx) const { return store_.Read<TilePoint>(tile_idx); }
  double BaseHeight() const { return base_height_; }
  // The side of a cell that holds a point almost everywhere where the tile's cloud is, as dense as
  // it is in all but a tenth of its area: 1, 2, 4, 8 or 16 pixels. A tile with little of the cloud
  // has the cells that most points of the map do with.
  int CellSize(int tile_idx) const { return cell_sizes_[static_cast<size_t>(tile_idx)]; }
  int UsualCellSize() const { return usual_cell_size_; }
  uint64_t NumOutside() const { return num_outside_; }  // of the map

 private:
  void Add(const Eigen::Vector3d& in_map, float confidence);
  bool IsWanted(int tile_idx) const {
    return is_wanted_.empty() || is_wanted_[static_cast<size_t>(tile_idx)];
  }
  void AddToTiles(const Eigen::Vector2d& pixel, float height, float weight);
  void FindCellSizes();
  std::vector<uint32_t> InnerCounts(const MapGrid::Box& box) const;

  MapGrid grid_;
  double base_height_;
  std::vector<uint8_t> is_wanted_;
  TileStore store_;
  std::vector<uint32_t> block_counts_;
  int num_blocks_x_ = 0, num_blocks_y_ = 0;
  std::vector<int> cell_sizes_;  // by tile
  int usual_cell_size_ = 1;
  uint64_t num_outside_ = 0;
};

}  // namespace colmap_seapoint
