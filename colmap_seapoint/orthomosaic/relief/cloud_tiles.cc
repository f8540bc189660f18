#include "colmap_seapoint/orthomosaic/relief/cloud_tiles.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/cloud_ranges.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"

namespace colmap_seapoint {
namespace {

constexpr uint64_t kSamplePoints = 100000;
constexpr uint64_t kSampleRanges = 1000;
constexpr uint64_t kReadPoints = 1 << 15;
constexpr int kBlock = 16;           // pixels
constexpr float kMinWeight = 0.01f;  // of a point without confidence: it counts where it is alone
// Points on a lattice of this spacing, in cells, leave no two empty cells side by side.
constexpr double kMaxSpacing = 1.3;
constexpr size_t kMinInnerBlocks = 50;  // that tell how dense a tile is
constexpr double kDenserShare = 0.9;    // of the area that is as dense as the cells need

// nullptr for clouds of other programs, whose points must be read one by one.
std::unique_ptr<CloudRanges> OpenOwnCloud(const std::filesystem::path& path) {
  try {
    return std::make_unique<CloudRanges>(path);
  } catch (const Error&) {
    return nullptr;  // what is wrong with it, CloudReader says
  }
}

using TakePoint = std::function<void(const Eigen::Vector3d& xyz, float confidence)>;

void ReadAllPoints(const std::filesystem::path& path, const TakePoint& take) {
  if (const auto ranges = OpenOwnCloud(path)) {
    for (uint64_t first = 0; first < ranges->NumPoints(); first += kReadPoints) {
      const uint64_t count = std::min(kReadPoints, ranges->NumPoints() - first);
      for (const CloudPoint& point : ranges->Read(first, count)) {
        if (point.xyz.allFinite()) take(point.xyz.cast<double>(), point.confidence);
      }
    }
    return;
  }
  CloudReader reader(path);
  for (CloudVertex vertex; reader.Next(&vertex);) take(vertex.xyz, vertex.confidence);
}

// Somewhere in part i, of `size`, of a file: clouds of other programs lie in rows, and what is
// taken at equal steps of them may all lie at one end.
uint64_t ScatteredIn(uint64_t i, uint64_t size) {
  uint64_t bits = (i + 1) * 0x9e3779b97f4a7c15ull;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ull;
  bits ^= bits >> 31;
  return bits % size;
}

std::vector<Eigen::Vector3d> SampleRanges(const CloudRanges& cloud) {
  std::vector<Eigen::Vector3d> sample;
  const uint64_t length = kSamplePoints / kSampleRanges;
  const uint64_t part = cloud.NumPoints() / kSampleRanges;
  for (uint64_t i = 0; i < kSampleRanges; ++i) {
    const uint64_t first = part * i + ScatteredIn(i, part - length + 1);
    for (const CloudPoint& point : cloud.Read(first, length)) {
      if (point.xyz.allFinite()) sample.push_back(point.xyz.cast<double>());
    }
  }
  return sample;
}

// For blocks that hold so many points.
int CellSizeFor(std::vector<uint32_t> counts) {
  const auto at =
      static_cast<std::ptrdiff_t>((1 - kDenserShare) * static_cast<double>(counts.size()));
  std::nth_element(counts.begin(), counts.begin() + at, counts.end());
  const double spacing = kBlock / std::sqrt(static_cast<double>(counts[static_cast<size_t>(at)]));
  int cell_size = 1;
  while (cell_size < kBlock && spacing > kMaxSpacing * cell_size) cell_size *= 2;
  return cell_size;
}

}  // namespace

std::vector<Eigen::Vector3d> SampleCloud(const std::filesystem::path& path) {
  std::vector<Eigen::Vector3d> sample;
  const auto ranges = OpenOwnCloud(path);
  if (ranges && ranges->NumPoints() > kSamplePoints) {
    sample = SampleRanges(*ranges);
  } else {
    const uint64_t num_points = ranges ? ranges->NumPoints() : CloudReader(path).NumPoints();
    const uint64_t stride = num_points / kSamplePoints + 1;
    uint64_t num_read = 0;
    ReadAllPoints(path, [&](const Eigen::Vector3d& xyz, float) {
      if (num_read % stride == ScatteredIn(num_read / stride, stride)) sample.push_back(xyz);
      ++num_read;
    });
  }
  if (sample.empty()) {
    throw Error(path.string(), "holds no points", "give a cloud with at least one");
  }
  return sample;
}

uint64_t NumPointsOf(const std::filesystem::path& path) { return CloudReader(path).NumPoints(); }

void ReadPointsFrom(const std::filesystem::path& path, uint64_t first,
                    const std::function<void(const Eigen::Vector3d&)>& take) {
  const CloudRanges cloud(path);
  while (first < cloud.NumPoints()) {
    const uint64_t count = std::min(kReadPoints, cloud.NumPoints() - first);
    for (const CloudPoint& point : cloud.Read(first, count)) {
      if (point.xyz.allFinite()) take(point.xyz.cast<double>());
    }
    first += count;
  }
}

CloudTiles::CloudTiles(const std::filesystem::path& path, const Rigid3d& map_from_cloud,
                       const MapGrid& grid, double base_height, const std::filesystem::path& folder,
                       std::vector<uint8_t> is_wanted)
    : grid_(grid),
      base_height_(base_height),
      is_wanted_(std::move(is_wanted)),
      store_(folder, grid.NumTiles(), sizeof(TilePoint)),
      num_blocks_x_((grid.width + kBlock - 1) / kBlock),
      num_blocks_y_((grid.height + kBlock - 1) / kBlock) {
  block_counts_.resize(static_cast<size_t>(num_blocks_x_) * static_cast<size_t>(num_blocks_y_));
  const Eigen::Matrix3d rotation = map_from_cloud.rotation.toRotationMatrix();
  ReadAllPoints(path, [&](const Eigen::Vector3d& xyz, float confidence) {
    Add(rotation * xyz + map_from_cloud.translation, confidence);
  });
  store_.Finish();
  FindCellSizes();
  std::vector<uint32_t>().swap(block_counts_);
}

void CloudTiles::Add(const Eigen::Vector3d& in_map, float confidence) {
  const Eigen::Vector2d pixel = grid_.PixelOf(in_map.x(), in_map.y());
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < grid_.width && pixel.y() < grid_.height)) {
    ++num_outside_;
    return;
  }
  const auto bx = static_cast<size_t>(pixel.x() / kBlock);
  const auto by = static_cast<size_t>(pixel.y() / kBlock);
  ++block_counts_[by * static_cast<size_t>(num_blocks_x_) + bx];
  const float weight = confidence > kMinWeight ? std::min(confidence, 1.0f) : kMinWeight;
  AddToTiles(pixel, static_cast<float>(in_map.z() - base_height_), weight);
}

void CloudTiles::AddToTiles(const Eigen::Vector2d& pixel, float height, float weight) {
  const int size = grid_.tile_size;
  const int column = static_cast<int>(pixel.x()), row = static_cast<int>(pixel.y());
  const int last_x = std::min((column + kTileHalo) / size, grid_.NumTilesX() - 1);
  const int last_y = std::min((row + kTileHalo) / size, grid_.NumTilesY() - 1);
  for (int ty = std::max(row - kTileHalo, 0) / size; ty <= last_y; ++ty) {
    for (int tx = std::max(column - kTileHalo, 0) / size; tx <= last_x; ++tx) {
      const TilePoint point = {static_cast<float>(pixel.x() - tx * size),
                               static_cast<float>(pixel.y() - ty * size), height, weight};
      const int tile = ty * grid_.NumTilesX() + tx;
      if (IsWanted(tile)) store_.Append(tile, &point);
    }
  }
}

// Numbers of points in the tile's blocks that are not at a border of the cloud.
std::vector<uint32_t> CloudTiles::InnerCounts(const MapGrid::Box& box) const {
  std::vector<uint32_t> inner;
  const auto count = [&](int x, int y) {
    return block_counts_[static_cast<size_t>(y) * static_cast<size_t>(num_blocks_x_) +
                         static_cast<size_t>(x)];
  };
  const int end_x = std::min((box.x + box.width) / kBlock, num_blocks_x_ - 1);
  const int end_y = std::min((box.y + box.height) / kBlock, num_blocks_y_ - 1);
  for (int y = std::max(box.y / kBlock, 1); y < end_y; ++y) {
    for (int x = std::max(box.x / kBlock, 1); x < end_x; ++x) {
      bool is_inner = true;
      for (int i = 0; i < 9; ++i) is_inner &= count(x + i % 3 - 1, y + i / 3 - 1) > 0;
      if (is_inner) inner.push_back(count(x, y));
    }
  }
  return inner;
}

void CloudTiles::FindCellSizes() {
  std::map<int, uint64_t> num_points;  // that do with cells of such a size
  cell_sizes_.assign(static_cast<size_t>(grid_.NumTiles()), 0);
  for (int i = 0; i < grid_.NumTiles(); ++i) {
    if (!IsWanted(i)) continue;
    std::vector<uint32_t> counts = InnerCounts(grid_.Tile(i));
    if (counts.size() < kMinInnerBlocks) continue;
    cell_sizes_[static_cast<size_t>(i)] = CellSizeFor(std::move(counts));
    num_points[cell_sizes_[static_cast<size_t>(i)]] += store_.NumRecords(i);
  }
  const auto usual =
      std::max_element(num_points.begin(), num_points.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (usual != num_points.end()) {
    usual_cell_size_ = usual->first;
  } else {
    std::vector<uint32_t> counts = InnerCounts({0, 0, grid_.width, grid_.height});
    if (!counts.empty()) usual_cell_size_ = CellSizeFor(std::move(counts));
  }
  std::replace(cell_sizes_.begin(), cell_sizes_.end(), 0, usual_cell_size_);
}

}  // namespace colmap_seapoint
