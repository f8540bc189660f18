#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/orthomosaic/relief/line_of_sight.h"

namespace colmap_seapoint {
namespace {

constexpr double kObliqueCost = 0.7;  // at 45 degrees from the map's normal
constexpr double kBorderCost = 0.5;   // in the picture's corners
constexpr double kMaxReach = 30;      // of a view, in its heights above the lowest surface
constexpr double kMinCosine = 0.15;   // of the angle from the map's normal

// What a picture costs for a place that it sees at `pixel`.
float CostOf(const MapView& view, const Eigen::Vector3d& place, const Eigen::Vector2d& pixel,
             double pixel_size, double cosine) {
  const Camera& camera = view.GetCamera();
  const double x = 2 * pixel.x() / camera.width - 1, y = 2 * pixel.y() / camera.height - 1;
  const double tangent2 = 1 / (cosine * cosine) - 1;
  // Finer than the map needs is no better.
  const double gsd = std::max(view.GsdAt(place) / pixel_size, 0.5);
  return static_cast<float>(std::log2(gsd) + kObliqueCost * tangent2 +
                            kBorderCost * 0.5 * (x * x + y * y));
}

// Keeps the cheapest, of equal ones the first.
void Offer(const Source& source, Source* sources) {
  int at = kMaxSources;
  while (at > 0 && (sources[at - 1].picture == kNoPicture || sources[at - 1].cost > source.cost)) {
    --at;
  }
  if (at == kMaxSources) return;
  std::move_backward(sources + at, sources + kMaxSources - 1, sources + kMaxSources);
  sources[at] = source;
}

class SourceFinder {
 public:
  SourceFinder(const Relief& relief, const std::vector<MapView>& views)
      : relief_(relief),
        views_(views),
        footprints_(FootprintBlocks(relief.Blocks(), relief.Grid(), views)) {}

  void FindInRow(int y, SourceBlocks* result) const {
    for (size_t i = 0; i < views_.size(); ++i) {
      const std::array<int, 4>& blocks = footprints_[i];
      if (y < blocks[1] || y > blocks[3]) continue;
      for (int x = blocks[0]; x <= blocks[2]; ++x) {
        const int32_t at = result->slot[relief_.Blocks().At(x, y)];
        if (at >= 0 && !result->IsKept(at))
          OfferPicture(static_cast<uint32_t>(i), x, y, result->Of(at));
      }
    }
  }

 private:
  void OfferPicture(uint32_t picture, int x, int y, Source* sources) const {
    const MapView& view = views_[picture];
    const Eigen::Vector3d place = PlaceInBlock(relief_, x, y);
    const auto pixel = view.PixelOf(place);
    if (!pixel) return;
    const double cosine = (view.Center() - place).normalized().z();
    if (!(cosine > kMinCosine)) return;
    const MapGrid& grid = relief_.Grid();
    Source source;
    source.picture = picture;
    source.cost = CostOf(view, place, *pixel, grid.pixel_size, cosine);
    const Source& last = sources[kMaxSources - 1];
    if (last.picture != kNoPicture && last.cost <= source.cost) return;
    const Eigen::Vector2d camera = grid.PixelOf(view.Center().x(), view.Center().y());
    if (IsBlockHidden(relief_.Blocks(), x, y, {camera.x(), camera.y(), view.Center().z()},
                      grid.pixel_size)) {
      return;
    }
    Offer(source, sources);
  }

  const Relief& relief_;
  const std::vector<MapView>& views_;
  std::vector<std::array<int, 4>> footprints_;
};

void TakeOver(const SourceBlocks& before, const std::vector<int32_t>& kept, SourceBlocks* result) {
  result->is_kept.assign(result->NumSlots(), 0);
  for (size_t i = 0; i < kept.size(); ++i) {
    const int32_t at = result->slot[i];
    if (at < 0 || kept[i] < 0) continue;
    result->is_kept[static_cast<size_t>(at)] = 1;
    std::copy_n(before.Of(kept[i]), kMaxSources, result->Of(at));
    result->choice[static_cast<size_t>(at)] = before.choice[static_cast<size_t>(kept[i])];
  }
}

}  // namespace

Eigen::Vector3d PlaceInBlock(const Relief& relief, int x, int y, double dx, double dy) {
  const MapGrid& grid = relief.Grid();
  const Eigen::Vector2d place =
      grid.PlaceOf((x + 0.5) * kBlockSize + dx, (y + 0.5) * kBlockSize + dy);
  return {place.x(), place.y(), double{relief.Blocks().mean[relief.Blocks().At(x, y)]}};
}

std::vector<std::array<int, 4>> FootprintBlocks(const BlockRelief& blocks, const MapGrid& grid,
                                                const std::vector<MapView>& views) {
  std::vector<std::array<int, 4>> result;
  result.reserve(views.size());
  for (const MapView& view : views) {
    const double low = double{blocks.lowest}, high = double{blocks.highest};
    const double reach = kMaxReach * std::max(view.Center().z() - low, high - low);
    const auto footprint = view.Footprint(low, high, reach);
    if (!footprint || !(reach > 0)) {
      result.push_back({1, 1, 0, 0});
      continue;
    }
    const auto [low_x, low_y, high_x, high_y] = *footprint;
    const Eigen::Array2d first = grid.PixelOf(low_x, high_y).array() / kBlockSize - 1;
    const Eigen::Array2d last = grid.PixelOf(high_x, low_y).array() / kBlockSize + 1;
    const auto block = [](double at, int most) {
      return static_cast<int>(std::clamp(std::floor(at), -1.0, static_cast<double>(most)));
    };
    result.push_back({std::max(block(first.x(), blocks.width), 0),
                      std::max(block(first.y(), blocks.height), 0),
                      std::min(block(last.x(), blocks.width), blocks.width - 1),
                      std::min(block(last.y(), blocks.height), blocks.height - 1)});
  }
  return result;
}

SourceBlocks FindSources(const Relief& relief, const std::vector<MapView>& views, int num_threads,
                         const SourceBlocks* before, const std::vector<int32_t>& kept) {
  SourceBlocks result;
  result.slot.assign(relief.Blocks().mean.size(), -1);
  int32_t num_slots = 0;
  for (size_t i = 0; i < result.slot.size(); ++i) {
    if (!std::isnan(relief.Blocks().mean[i])) result.slot[i] = num_slots++;
  }
  result.sources.resize(static_cast<size_t>(num_slots) * kMaxSources);
  result.choice.resize(static_cast<size_t>(num_slots), 0);
  if (before != nullptr) TakeOver(*before, kept, &result);
  const SourceFinder finder(relief, views);
  ParallelFor(num_threads, relief.Blocks().height,
              [&](int64_t y) { finder.FindInRow(static_cast<int>(y), &result); });
  return result;
}

}  // namespace colmap_seapoint
