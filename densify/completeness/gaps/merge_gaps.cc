#include "densify/completeness/gaps/merge_gaps.h"

#include <algorithm>
#include <unordered_set>

namespace colmap_seapoint {
namespace {

constexpr double kReach = 0.5;  // of a picture's shorter side
constexpr int kReachBlocks = 4;
constexpr double kSpeck = 0.01;  // of a picture

using Blocks = std::unordered_set<TileKey, TileKeyHash>;

// Squares of `size` cells that hold cells of the region.
Blocks BlocksOf(const GapRegion& region, int size) {
  const auto block = [&](int at) { return at >= 0 ? at / size : -1 - (-1 - at) / size; };
  Blocks blocks;
  for (const auto& [x, y] : region.cells) blocks.insert({block(x), block(y)});
  return blocks;
}

Blocks Around(const Blocks& blocks) {
  Blocks around;
  for (const TileKey& key : blocks) {
    for (int dy = -kReachBlocks; dy <= kReachBlocks; ++dy) {
      for (int dx = -kReachBlocks; dx <= kReachBlocks; ++dx) {
        if (dx * dx + dy * dy <= kReachBlocks * kReachBlocks) {
          around.insert({key.x + dx, key.y + dy});
        }
      }
    }
  }
  return around;
}

bool IsWithin(const Blocks& blocks, const Blocks& around) {
  return std::all_of(blocks.begin(), blocks.end(),
                     [&](const TileKey& key) { return around.count(key) > 0; });
}

bool IsSameLayer(const GapRegion& a, const GapRegion& b) {
  return !(a.layer < b.layer) && !(b.layer < a.layer);
}

void Append(const GapRegion& part, GapRegion* whole) {
  whole->cells.insert(whole->cells.end(), part.cells.begin(), part.cells.end());
  whole->area += part.area;
}

void Finish(double cell_side, GapRegion* region) {
  std::sort(region->cells.begin(), region->cells.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second < b.second : a.first < b.first;
  });
  region->rings = TraceCells(region->cells);
  for (Ring& ring : region->rings) {
    for (Eigen::Vector2d& corner : ring) corner *= cell_side;
  }
}

}  // namespace

PassRegions MergeIntoPasses(std::vector<GapRegion> regions, const PassPlan& plan,
                            double cell_side) {
  std::stable_sort(regions.begin(), regions.end(), [](const GapRegion& a, const GapRegion& b) {
    return IsSameLayer(a, b) ? a.area > b.area : a.layer < b.layer;
  });
  const double picture = plan.across * plan.along;
  const double reach = kReach * std::min(plan.across, plan.along) / cell_side;
  const int size = std::max(1, static_cast<int>(reach / kReachBlocks));
  std::vector<Blocks> blocks;
  for (const GapRegion& region : regions) blocks.push_back(BlocksOf(region, size));
  std::vector<bool> is_taken(regions.size(), false);
  PassRegions merged;
  for (size_t i = 0; i < regions.size(); ++i) {
    if (is_taken[i]) continue;
    const Blocks around = Around(blocks[i]);
    GapRegion whole = regions[i];
    for (size_t k = i + 1; k < regions.size() && IsSameLayer(regions[i], regions[k]); ++k) {
      const GapRegion& part = regions[k];
      const bool may_belong =
          part.cause == whole.cause ? part.area < picture : part.area < kSpeck * picture;
      if (is_taken[k] || !may_belong || !IsWithin(blocks[k], around)) continue;
      is_taken[k] = true;
      Append(part, &whole);
    }
    if (whole.area < kSpeck * picture) {
      merged.unlisted_area += whole.area;
      continue;
    }
    if (whole.cells.size() > regions[i].cells.size()) Finish(cell_side, &whole);
    merged.regions.push_back(std::move(whole));
  }
  return merged;
}

}  // namespace colmap_seapoint
