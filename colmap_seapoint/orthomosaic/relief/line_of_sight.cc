#include "colmap_seapoint/orthomosaic/relief/line_of_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace colmap_seapoint {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();

// From `begin` pixels of the way on, a block at a time, or a region where all around is
// lower.
bool IsHiddenByBlocks(const BlockRelief& blocks, const MapPlace& place, const Rise& rise,
                      double begin, double tolerance) {
  for (double s = begin; s < rise.reach;) {
    const double height = place.z() + s * rise.slope;
    if (rise.slope >= 0 && height >= double{blocks.highest}) return false;
    const int x = static_cast<int>(std::floor((place.x() + s * rise.dx) / kBlockSize));
    const int y = static_cast<int>(std::floor((place.y() + s * rise.dy) / kBlockSize));
    if (!blocks.Contains(x, y)) return false;
    if (double{blocks.mean[blocks.At(x, y)]} > height + tolerance) return true;
    const bool is_above = rise.slope >= 0 && height >= double{blocks.HighestAround(x, y)};
    s += kBlockSize * (is_above ? kRegionBlocks : 1);
  }
  return false;
}

}  // namespace

bool IsBlockHidden(const BlockRelief& blocks, int x, int y, const MapPlace& camera,
                   double pixel_size) {
  const MapPlace place((x + 0.5) * kBlockSize, (y + 0.5) * kBlockSize,
                       double{blocks.mean[blocks.At(x, y)]});
  return IsHiddenByBlocks(blocks, place, LineOfSight::RiseTo(place, camera), kBlockSize,
                          kBlockSize * pixel_size);
}

LineOfSight::LineOfSight(const ReliefTile& tile, const MapGrid::Box& box, const BlockRelief& blocks,
                         double tolerance)
    : heights_(tile.heights),
      box_(box),
      blocks_(blocks),
      tolerance_(tolerance),
      block_tops_((heights_.width + kBlockSize - 1) / kBlockSize,
                  (heights_.height + kBlockSize - 1) / kBlockSize, 1, kNothing) {
  FloatImage tops = block_tops_;
  for (int y = 0; y < heights_.height; ++y) {
    for (int x = 0; x < heights_.width; ++x) {
      float& top = tops.At(x / kBlockSize, y / kBlockSize);
      if (heights_.At(x, y) > top) top = heights_.At(x, y);
    }
  }
  for (int y = 0; y < tops.height; ++y) {
    for (int x = 0; x < tops.width; ++x) {
      for (int i = 0; i < 9; ++i) {
        const int u = x + i % 3 - 1, v = y + i / 3 - 1;
        if (tops.Contains(u, v))
          block_tops_.At(x, y) = std::max(block_tops_.At(x, y), tops.At(u, v));
      }
    }
  }
}

Rise LineOfSight::RiseTo(const MapPlace& place, const MapPlace& camera) {
  const Eigen::Vector3d way = camera - place;
  const double length = std::hypot(way.x(), way.y());
  return {way.x() / length, way.y() / length, length, way.z() / length, length};
}

bool LineOfSight::IsHiddenAlong(const MapPlace& place, const Rise& rise) const {
  if (!(rise.length > 1)) return false;
  const double first_x = place.x() - box_.x + kReliefMargin;
  const double first_y = place.y() - box_.y + kReliefMargin;
  double s = 1;
  while (s < rise.reach) {
    const double height = place.z() + s * rise.slope + tolerance_;
    if (rise.slope >= 0 && height >= double{blocks_.highest}) return false;
    const int x = static_cast<int>(std::floor(first_x + s * rise.dx));
    const int y = static_cast<int>(std::floor(first_y + s * rise.dy));
    if (!heights_.Contains(x, y)) break;
    if (double{heights_.At(x, y)} > height) return true;
    // A ray above all blocks around cannot meet any of them within a block's length.
    const bool is_above = double{block_tops_.At(x / kBlockSize, y / kBlockSize)} <= height;
    s += is_above && rise.slope >= 0 ? kBlockSize : 1;
  }
  return IsHiddenByBlocks(blocks_, place, rise, std::max(s, 1.0), tolerance_);
}

// Of a place of the map: the highest surface in the block and the eight around it, in the tile of
// all pixels, beyond it of the blocks' means.
double LineOfSight::TopAround(double x, double y) const {
  const int column = static_cast<int>(std::floor(x)) - box_.x + kReliefMargin;
  const int row = static_cast<int>(std::floor(y)) - box_.y + kReliefMargin;
  float top = kNothing;
  if (heights_.Contains(column, row)) {
    top = block_tops_.At(column / kBlockSize, row / kBlockSize);
  }
  const int bx = static_cast<int>(std::floor(x / kBlockSize));
  const int by = static_cast<int>(std::floor(y / kBlockSize));
  for (int i = 0; i < 9; ++i) {
    const int u = bx + i % 3 - 1, v = by + i / 3 - 1;
    if (blocks_.Contains(u, v)) top = std::fmax(top, blocks_.mean[blocks_.At(u, v)]);
  }
  return double{top};
}

double LineOfSight::ReachOf(const MapPlace& place, const Rise& rise) const {
  if (!(rise.slope >= 0)) return rise.length;
  constexpr double kStep = 0.5 * kBlockSize;
  double reach = 0;
  for (double s = 0; s < rise.length; s += kStep) {
    const double height = place.z() + s * rise.slope + tolerance_;
    if (height >= double{blocks_.highest}) break;
    const double x = place.x() + s * rise.dx, y = place.y() + s * rise.dy;
    const int bx = static_cast<int>(std::floor(x / kBlockSize));
    const int by = static_cast<int>(std::floor(y / kBlockSize));
    if (!blocks_.Contains(bx, by)) break;
    if (TopAround(x, y) > height) reach = s + kBlockSize;
  }
  return reach;
}

}  // namespace colmap_seapoint
