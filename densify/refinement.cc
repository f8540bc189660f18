#include "densify/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "colmap_seapoint/base/parallel.h"
#include "densify/surface_fit.h"
#include "densify/tile_kernels.h"

namespace colmap_seapoint {

namespace {

constexpr int kNodesX = tile::kNodesX, kNodesY = tile::kNodesY;
constexpr int kOwnX = kNodesX - 2, kOwnY = kNodesY - 2;  // nodes of the tile itself
constexpr float kMaxSlope = 1.2f;  // pixels of disparity a pixel, on one surface
constexpr int kMinLayerNodes = 3;
constexpr int kSmallWindow = 5;     // near depth edges, where the larger one fits on no side
constexpr float kSmallZncc = 0.15f;  // more than that of the larger one: fewer pixels agree by chance

// The nodes of a tile and one ring around; 0 where nothing matched.
using Patch = std::array<std::array<float, kNodesX>, kNodesY>;
// One surface in a patch: its nodes.
using Layer = std::array<std::array<bool, kNodesX>, kNodesY>;

Patch PatchAt(const PartialDisparity& nodes, int tile_a, int tile_b) {
  Patch patch{};
  for (int v = 0; v < kNodesY; ++v) {
    const int b = tile_b * kOwnY + v - 1;
    if (b < 0 || b >= nodes.grid.height) continue;
    for (int u = 0; u < kNodesX; ++u) {
      const int a = tile_a * kOwnX + u - 1;
      if (a < 0 || a >= nodes.grid.width) continue;
      patch[static_cast<size_t>(v)][static_cast<size_t>(u)] =
          nodes.disparity[static_cast<size_t>(b) * static_cast<size_t>(nodes.grid.width) +
                          static_cast<size_t>(a)];
    }
  }
  return patch;
}

// Nodes that hang together without a depth edge, from (u, v) on; marks them in `seen`.
Layer LayerFrom(const Patch& patch, int u, int v, Layer* seen, int* num_nodes) {
  constexpr float kTolerance = kMaxSlope * kNodeStep;
  Layer layer{};
  std::array<std::array<int, 2>, kNodesX * kNodesY> stack;
  size_t size = 0;
  const auto push = [&](int x, int y) {
    (*seen)[static_cast<size_t>(y)][static_cast<size_t>(x)] = true;
    layer[static_cast<size_t>(y)][static_cast<size_t>(x)] = true;
    stack[size++] = {x, y};
    ++*num_nodes;
  };
  *num_nodes = 0;
  push(u, v);
  while (size > 0) {
    const auto [x, y] = stack[--size];
    const float here = patch[static_cast<size_t>(y)][static_cast<size_t>(x)];
    constexpr int kAround[4][2] = {{0, -1}, {-1, 0}, {1, 0}, {0, 1}};
    for (const auto& step : kAround) {
      const int x2 = x + step[0], y2 = y + step[1];
      if (x2 < 0 || y2 < 0 || x2 >= kNodesX || y2 >= kNodesY) continue;
      const float there = patch[static_cast<size_t>(y2)][static_cast<size_t>(x2)];
      if (there <= 0 || (*seen)[static_cast<size_t>(y2)][static_cast<size_t>(x2)]) continue;
      if (std::abs(there - here) <= kTolerance) push(x2, y2);
    }
  }
  return layer;
}

// The layer's surface over the whole patch: beyond its nodes, each node continues the mean of the
// neighbours that are there already, ring by ring.
tile::Prediction Extend(const Patch& patch, Layer layer) {
  tile::Prediction surface{};
  for (size_t v = 0; v < kNodesY; ++v) {
    for (size_t u = 0; u < kNodesX; ++u) {
      if (layer[v][u]) surface[v][u] = patch[v][u];
    }
  }
  for (bool changed = true; changed;) {
    changed = false;
    const Layer known = layer;
    for (int v = 0; v < kNodesY; ++v) {
      for (int u = 0; u < kNodesX; ++u) {
        if (known[static_cast<size_t>(v)][static_cast<size_t>(u)]) continue;
        float sum = 0;
        int count = 0;
        for (int y = std::max(0, v - 1); y <= std::min(kNodesY - 1, v + 1); ++y) {
          for (int x = std::max(0, u - 1); x <= std::min(kNodesX - 1, u + 1); ++x) {
            if (!known[static_cast<size_t>(y)][static_cast<size_t>(x)]) continue;
            float value = surface[static_cast<size_t>(y)][static_cast<size_t>(x)];
            const int x2 = 2 * x - u, y2 = 2 * y - v;  // the node beyond: continue the slope
            if (x2 >= 0 && y2 >= 0 && x2 < kNodesX && y2 < kNodesY &&
                known[static_cast<size_t>(y2)][static_cast<size_t>(x2)]) {
              value += value - surface[static_cast<size_t>(y2)][static_cast<size_t>(x2)];
            }
            sum += value;
            ++count;
          }
        }
        if (count == 0) continue;
        surface[static_cast<size_t>(v)][static_cast<size_t>(u)] = sum / static_cast<float>(count);
        layer[static_cast<size_t>(v)][static_cast<size_t>(u)] = true;
        changed = true;
      }
    }
  }
  return surface;
}

// Samples, the last one beyond.
struct SampleBox {
  int begin_a, begin_b, end_a, end_b;
};

// Nodes of the tile (without the ring) that the layer may fill: of the open ones its own and their
// neighbours. Returns false when there are none.
struct NodeBox {
  int u0 = kNodesX, v0 = kNodesY, u1 = 0, v1 = 0;  // u1, v1: one beyond
};

bool Widen(const Layer& layer, const Layer& open, Layer* wide, NodeBox* box) {
  *wide = Layer{};
  for (int v = 1; v <= kOwnY; ++v) {
    for (int u = 1; u <= kOwnX; ++u) {
      if (!open[static_cast<size_t>(v)][static_cast<size_t>(u)]) continue;
      bool near = false;
      for (int y = v - 1; y <= v + 1; ++y) {
        for (int x = u - 1; x <= u + 1; ++x) {
          near = near || layer[static_cast<size_t>(y)][static_cast<size_t>(x)];
        }
      }
      if (!near) continue;
      (*wide)[static_cast<size_t>(v)][static_cast<size_t>(u)] = true;
      box->u0 = std::min(box->u0, u);
      box->v0 = std::min(box->v0, v);
      box->u1 = std::max(box->u1, u + 1);
      box->v1 = std::max(box->v1, v + 1);
    }
  }
  return box->u1 > 0;
}

class Refinement {
 public:
  Refinement(const RectPicture& picture1, const RectPicture& picture2, const Gate& gate,
             const PartialDisparity& nodes, const RefinementOptions& options)
      : gate_(gate), nodes_(nodes), options_(options) {
    pair_.gray1 = &picture1.gray;
    pair_.gray2 = &picture2.gray;
    pair_.column_shift = picture1.window.x0 - picture2.window.x0;
    pair_.row_shift = picture1.window.y0 - picture2.window.y0;
    pair_.window = options.window_size;
    result_.grid = SampleGrid(picture1.window, options.step);
    result_.disparity.assign(result_.grid.Size(), 0);
    result_.score.assign(result_.grid.Size(), -1);
  }

  int TilesX() const { return (nodes_.grid.width + kOwnX - 1) / kOwnX; }
  int TilesY() const { return (nodes_.grid.height + kOwnY - 1) / kOwnY; }

  void RefineTile(int tile_a, int tile_b) {
    const Patch patch = PatchAt(nodes_, tile_a, tile_b);
    Layer seen{};
    for (int v = 0; v < kNodesY; ++v) {
      for (int u = 0; u < kNodesX; ++u) {
        if (patch[static_cast<size_t>(v)][static_cast<size_t>(u)] <= 0 ||
            seen[static_cast<size_t>(v)][static_cast<size_t>(u)]) {
          continue;
        }
        int num_nodes = 0;
        const Layer layer = LayerFrom(patch, u, v, &seen, &num_nodes);
        if (num_nodes < kMinLayerNodes) continue;
        MatchLayer(Extend(patch, layer), layer, tile_a, tile_b);
      }
    }
  }

  // Nodes of the tiles that had no disparity and whose square is largely matched now take it over;
  // returns the tiles that see such a node.
  std::vector<int> GrowNodes(const std::vector<int>& tiles, PartialDisparity* nodes) const {
    std::vector<uint8_t> touched(static_cast<size_t>(TilesX()) * static_cast<size_t>(TilesY()), 0);
    for (const int tile : tiles) {
      const int first_a = tile % TilesX() * kOwnX, first_b = tile / TilesX() * kOwnY;
      const int end_a = std::min(nodes->grid.width, first_a + kOwnX);
      const int end_b = std::min(nodes->grid.height, first_b + kOwnY);
      for (int b = first_b; b < end_b; ++b) {
        for (int a = first_a; a < end_a; ++a) {
          float& node = nodes->disparity[nodes->grid.NodeOf(a, b)];
          if (node > 0 || gate_.At(a * kNodeStep, b * kNodeStep) == Gate::kClosed) continue;
          node = MedianInNode(a, b);
          if (node > 0) Touch(a, b, &touched);
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
  void MatchLayer(const tile::Prediction& surface, const Layer& layer, int tile_a, int tile_b) {
    Layer wide;
    NodeBox box;
    if (!Widen(layer, OpenNodes(tile_a, tile_b), &wide, &box)) return;
    const SampleGrid& grid = result_.grid;
    tile::Region region;
    region.tile_x = tile_a * tile::kWidth;
    region.tile_y = tile_b * tile::kHeight;
    region.x0 = (box.u0 - 1) * kNodeStep;
    region.y0 = (box.v0 - 1) * kNodeStep;
    region.width = (box.u1 - box.u0) * kNodeStep;
    region.height = (box.v1 - box.v0) * kNodeStep;
    const int left = region.tile_x + region.x0, top = region.tile_y + region.y0;
    const SampleBox samples = {
        grid.FirstFrom(left), grid.FirstFrom(top),
        std::min(grid.width, grid.FirstFrom(left + region.width)),
        std::min(grid.height, grid.FirstFrom(top + region.height))};
    region.first_row = grid.PixelY(samples.begin_b) - top;
    region.row_step = grid.step;
    if (region.first_row >= region.height) return;
    if (MatchRegion(surface, wide, region, samples, options_.window_size, options_.min_zncc) &&
        options_.window_size > kSmallWindow) {
      MatchRegion(surface, wide, region, samples, kSmallWindow, options_.min_zncc + kSmallZncc);
    }
  }

  Layer OpenNodes(int tile_a, int tile_b) const {
    Layer open{};
    for (int v = 1; v <= kOwnY; ++v) {
      for (int u = 1; u <= kOwnX; ++u) {
        const int a = tile_a * kOwnX + u - 1, b = tile_b * kOwnY + v - 1;
        open[static_cast<size_t>(v)][static_cast<size_t>(u)] =
            a < nodes_.grid.width && b < nodes_.grid.height &&
            gate_.At(a * kNodeStep, b * kNodeStep) != Gate::kClosed;
      }
    }
    return open;
  }

  // The median of a node's samples, 0 when fewer than half are matched.
  float MedianInNode(int a, int b) const {
    const SampleGrid& grid = result_.grid;
    std::array<float, kNodeStep * kNodeStep> found;
    size_t num_found = 0, all = 0;
    const int end_a = std::min(grid.width, grid.FirstFrom((a + 1) * kNodeStep));
    const int end_b = std::min(grid.height, grid.FirstFrom((b + 1) * kNodeStep));
    for (int v = grid.FirstFrom(b * kNodeStep); v < end_b; ++v) {
      for (int u = grid.FirstFrom(a * kNodeStep); u < end_a; ++u) {
        const float disparity = result_.disparity[static_cast<size_t>(v) *
                                                      static_cast<size_t>(grid.width) +
                                                  static_cast<size_t>(u)];
        ++all;
        if (disparity > 0) found[num_found++] = disparity;
      }
    }
    if (num_found == 0 || 2 * num_found < all) return 0;
    const auto middle = found.begin() + static_cast<std::ptrdiff_t>(num_found / 2);
    std::nth_element(found.begin(), middle, found.begin() + static_cast<std::ptrdiff_t>(num_found));
    return *middle;
  }

  // Marks the tiles whose patch holds a node.
  void Touch(int a, int b, std::vector<uint8_t>* touched) const {
    for (int y = std::max(0, b - 1) / kOwnY; y <= std::min(TilesY() - 1, (b + 1) / kOwnY); ++y) {
      for (int x = std::max(0, a - 1) / kOwnX; x <= std::min(TilesX() - 1, (a + 1) / kOwnX); ++x) {
        (*touched)[static_cast<size_t>(y) * static_cast<size_t>(TilesX()) +
                   static_cast<size_t>(x)] = 1;
      }
    }
  }

  // Fills samples that have nothing better, the small window only those that have nothing; returns
  // whether any is left empty.
  bool MatchRegion(const tile::Prediction& surface, const Layer& wide, const tile::Region& region,
                   const SampleBox& samples, int window, float min_zncc) {
    const SampleGrid& grid = result_.grid;
    tile::Pair pair = pair_;
    pair.window = window;
    alignas(64) std::array<float, tile::kRowStride * tile::kHeight> residual, score;
    tile::Match(pair, region, surface, residual.data(), score.data());
    bool any_empty = false;
    for (int b = samples.begin_b; b < samples.end_b; ++b) {
      const int y = grid.PixelY(b) - region.tile_y;
      const auto& wide_row = wide[static_cast<size_t>(y / kNodeStep) + 1];
      const int row = (b - samples.begin_b) * tile::kRowStride - region.x0;
      for (int a = samples.begin_a; a < samples.end_a; ++a) {
        const int x = grid.PixelX(a) - region.tile_x;
        if (!wide_row[static_cast<size_t>(x / kNodeStep) + 1]) continue;
        const size_t at = static_cast<size_t>(row + x);
        const size_t sample =
            static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
        const bool held = result_.disparity[sample] > 0;
        const float disparity = tile::PredictedAt(surface, x, y) + residual[at];
        if (score[at] <= 0 || score[at] < min_zncc || disparity <= 0 ||
            score[at] <= result_.score[sample] || (held && window != options_.window_size)) {
          any_empty = any_empty || !held;
          continue;
        }
        result_.disparity[sample] = disparity;
        result_.score[sample] = score[at];
      }
    }
    return any_empty;
  }

  const Gate& gate_;
  const PartialDisparity& nodes_;
  const RefinementOptions options_;
  tile::Pair pair_;
  PartialDisparity result_;
};

}  // namespace

PartialDisparity Refine(const RectPicture& picture1, const RectPicture& picture2,
                        const Gate& gate, const PartialDisparity& nodes,
                        const RefinementOptions& options, int num_threads) {
  // Noise in a node would bend every window around it.
  PartialDisparity smooth = nodes;
  smooth.disparity = FitSurface(nodes, 1, kMaxSlope, num_threads).disparity;
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
