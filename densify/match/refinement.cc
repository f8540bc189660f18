#include "densify/match/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "colmap_seapoint/base/parallel.h"
#include "densify/kernels/tile_kernels.h"
#include "densify/match/surface_fit.h"
#include "densify/match/surface_layers.h"

namespace colmap_seapoint {

namespace {

constexpr int kSmallWindow = 5;      // near depth edges, where the larger one fits on no side
constexpr float kSmallZncc = 0.15f;  // more than the larger one's: few pixels agree by chance

// Samples, the last one beyond.
struct SampleBox {
  int begin_a, begin_b, end_a, end_b;
};

class Refinement {
 public:
  Refinement(const RectPicture& picture1, const RectPicture& picture2, const Gate& gate,
             const PartialDisparity& nodes, const RefinementOptions& options)
      : gate_(gate),
        nodes_(nodes),
        options_(options),
        own_x_(tile::kWidth / nodes.grid.step),
        own_y_(tile::kHeight / nodes.grid.step) {
    pair_.gray1 = &picture1.gray;
    pair_.gray2 = &picture2.gray;
    pair_.column_shift = picture1.window.x0 - picture2.window.x0;
    pair_.row_shift = picture1.window.y0 - picture2.window.y0;
    result_.grid = SampleGrid(picture1.window, options.step);
    result_.disparity.assign(result_.grid.Size(), 0);
    result_.score.assign(result_.grid.Size(), -1);
    result_.deviation.assign(result_.grid.Size(), 0);
  }

  int TilesX() const { return (nodes_.grid.width + own_x_ - 1) / own_x_; }
  int TilesY() const { return (nodes_.grid.height + own_y_ - 1) / own_y_; }

  void RefineTile(int tile_a, int tile_b) {
    ForEachLayer(nodes_, gate_, tile_a, tile_b,
                 [&](const SurfaceLayer& layer) { MatchLayer(layer, tile_a, tile_b); });
  }

  // Nodes of the tiles that had no disparity and whose square is largely matched now take it over;
  // returns the tiles that see such a node.
  std::vector<int> GrowNodes(const std::vector<int>& tiles, PartialDisparity* nodes) const {
    std::vector<uint8_t> touched(static_cast<size_t>(TilesX()) * static_cast<size_t>(TilesY()), 0);
    for (const int tile : tiles) {
      const int first_a = tile % TilesX() * own_x_, first_b = tile / TilesX() * own_y_;
      const int end_a = std::min(nodes->grid.width, first_a + own_x_);
      const int end_b = std::min(nodes->grid.height, first_b + own_y_);
      for (int b = first_b; b < end_b; ++b) {
        for (int a = first_a; a < end_a; ++a) {
          const size_t node = static_cast<size_t>(b) * static_cast<size_t>(nodes->grid.width) +
                              static_cast<size_t>(a);
          if (nodes->disparity[node] > 0 || gate_[node] == Gate::kClosed) continue;
          nodes->disparity[node] = MedianInNode(a, b);
          if (nodes->disparity[node] > 0) Touch(a, b, &touched);
        }
      }
    }
    std::vector<int> next;
    for (size_t t = 0; t < touched.size(); ++t) {
      if (touched[t]) next.push_back(static_cast<int>(t));
    }
    return next;
  }

  PartialDisparity TakeResult() { return std::move(result_); }

 private:
  void MatchLayer(const SurfaceLayer& layer, int tile_a, int tile_b) {
    const SampleGrid& grid = result_.grid;
    const int node_step = nodes_.grid.step;
    tile::Region region;
    region.tile_x = tile_a * tile::kWidth;
    region.tile_y = tile_b * tile::kHeight;
    region.x0 = (layer.u0 - 1) * node_step;
    region.y0 = (layer.v0 - 1) * node_step;
    region.width = (layer.u1 - layer.u0) * node_step;
    region.height = (layer.v1 - layer.v0) * node_step;
    const int left = region.tile_x + region.x0, top = region.tile_y + region.y0;
    const SampleBox samples = {grid.FirstFrom(left), grid.FirstFrom(top),
                               std::min(grid.width, grid.FirstFrom(left + region.width)),
                               std::min(grid.height, grid.FirstFrom(top + region.height))};
    region.first_row = grid.PixelY(samples.begin_b) - top;
    region.row_step = grid.step;
    if (region.first_row >= region.height) return;
    if (MatchRegion(layer, region, samples, options_.window_size, options_.min_zncc) &&
        options_.window_size > kSmallWindow) {
      MatchRegion(layer, region, samples, kSmallWindow, options_.min_zncc + kSmallZncc);
    }
  }

  // Fills samples that have nothing better, the small window only those that have nothing; returns
  // whether any is left empty.
  bool MatchRegion(const SurfaceLayer& layer, const tile::Region& region, const SampleBox& samples,
                   int window, float min_zncc) {
    const SampleGrid& grid = result_.grid;
    tile::Pair pair = pair_;
    pair.window = window;
    alignas(64) std::array<float, tile::kRowStride * tile::kHeight> residual, score, deviation;
    tile::Match(pair, region, layer.surface, {residual.data(), score.data(), deviation.data()});
    bool any_empty = false;
    for (int b = samples.begin_b; b < samples.end_b; ++b) {
      const int y = grid.PixelY(b) - region.tile_y;
      const auto& near_row = layer.near[static_cast<size_t>(y / nodes_.grid.step) + 1];
      const int row = (b - samples.begin_b) * tile::kRowStride - region.x0;
      for (int a = samples.begin_a; a < samples.end_a; ++a) {
        const int x = grid.PixelX(a) - region.tile_x;
        if (!near_row[static_cast<size_t>(x / nodes_.grid.step) + 1]) continue;
        const size_t at = static_cast<size_t>(row + x);
        const size_t sample =
            static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
        const bool held = result_.disparity[sample] > 0;
        const float disparity = tile::PredictedAt(layer.surface, x, y) + residual[at];
        if (score[at] <= 0 || score[at] < min_zncc || disparity <= 0 ||
            score[at] <= result_.score[sample] || (held && window != options_.window_size)) {
          any_empty = any_empty || !held;
          continue;
        }
        result_.disparity[sample] = disparity;
        result_.score[sample] = score[at];
        result_.deviation[sample] = deviation[at];
      }
    }
    return any_empty;
  }

  // The median of a node's samples, 0 when fewer than half are matched.
  float MedianInNode(int a, int b) const {
    const SampleGrid& grid = result_.grid;
    const int step = nodes_.grid.step;
    std::array<float, kMaxNodeStep * kMaxNodeStep> found;
    size_t num_found = 0, all = 0;
    const int end_a = std::min(grid.width, grid.FirstFrom((a + 1) * step));
    const int end_b = std::min(grid.height, grid.FirstFrom((b + 1) * step));
    for (int v = grid.FirstFrom(b * step); v < end_b; ++v) {
      const float* row =
          result_.disparity.data() + static_cast<size_t>(v) * static_cast<size_t>(grid.width);
      for (int u = grid.FirstFrom(a * step); u < end_a; ++u) {
        ++all;
        if (row[u] > 0) found[num_found++] = row[u];
      }
    }
    if (num_found == 0 || 2 * num_found < all) return 0;
    const auto middle = found.begin() + static_cast<std::ptrdiff_t>(num_found / 2);
    std::nth_element(found.begin(), middle, found.begin() + static_cast<std::ptrdiff_t>(num_found));
    return *middle;
  }

  // Marks the tiles that hold a node, or have it in the ring around them.
  void Touch(int a, int b, std::vector<uint8_t>* touched) const {
    for (int y = std::max(0, b - 1) / own_y_; y <= std::min(TilesY() - 1, (b + 1) / own_y_); ++y) {
      for (int x = std::max(0, a - 1) / own_x_; x <= std::min(TilesX() - 1, (a + 1) / own_x_);
           ++x) {
        (*touched)[static_cast<size_t>(y) * static_cast<size_t>(TilesX()) +
                   static_cast<size_t>(x)] = 1;
      }
    }
  }

  const Gate& gate_;
  const PartialDisparity& nodes_;
  const RefinementOptions options_;
  const int own_x_, own_y_;  // nodes across and down a tile
  tile::Pair pair_;
  PartialDisparity result_;
};

}  // namespace

PartialDisparity Refine(const RectPicture& picture1, const RectPicture& picture2, const Gate& gate,
                        const PartialDisparity& nodes, const RefinementOptions& options,
                        int num_threads) {
  // Noise in a node would bend every window around it.
  PartialDisparity smooth = nodes;
  smooth.disparity = FitSurface(nodes, 1, kMaxLayerSlope, num_threads).disparity;
  Refinement refinement(picture1, picture2, gate, smooth, options);
  const int tiles_x = refinement.TilesX(), tiles_y = refinement.TilesY();
  std::vector<int> tiles(static_cast<size_t>(tiles_x) * static_cast<size_t>(tiles_y));
  std::iota(tiles.begin(), tiles.end(), 0);
  for (int pass = 0; pass < kMaxRefinementSpread && !tiles.empty(); ++pass) {
    ParallelFor(num_threads, static_cast<int64_t>(tiles.size()), [&](int64_t t) {
      const int tile = tiles[static_cast<size_t>(t)];
      refinement.RefineTile(tile % tiles_x, tile / tiles_x);
    });
    tiles = refinement.GrowNodes(tiles, &smooth);
  }
  PartialDisparity result = refinement.TakeResult();
  result.num_failed_seeds = nodes.num_failed_seeds;
  return result;
}

}  // namespace colmap_seapoint
