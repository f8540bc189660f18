#include "densify/match/consistency.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {

namespace {

constexpr float kMaxSlope = 1.5f;   // pixels of disparity a pixel, on one surface
constexpr int kMinAgreeing = 3;     // of a sample's 8 neighbours
constexpr int kMinSpeckSize = 12;   // nodes
constexpr uint8_t kMinSupport = 6;  // samples of one surface, in a window of 25 or more

float SurfaceTolerance(const PartialDisparity& partial) {
  return std::max(1.0f, kMaxSlope * static_cast<float>(partial.grid.step));
}

void Remove(size_t node, PartialDisparity* partial) {
  partial->disparity[node] = 0;
  partial->score[node] = -1;
}

// Two samples of a row that land on the same place of picture 2 at different disparities cannot
// both be right (one of them is occluded there): the better score stays. `owner` is lent.
void RemoveDoubleClaims(int b, PartialDisparity* partial, std::vector<int>* owner) {
  const SampleGrid& grid = partial->grid;
  const float tolerance = 1.0f + SurfaceTolerance(*partial);
  const size_t row = static_cast<size_t>(b) * static_cast<size_t>(grid.width);
  const float* disparity = partial->disparity.data() + row;
  const float* score = partial->score.data() + row;
  float smallest = 1e9f, largest = 0;
  for (int a = 0; a < grid.width; ++a) {
    if (disparity[a] <= 0) continue;
    smallest = std::min(smallest, disparity[a]);
    largest = std::max(largest, disparity[a]);
  }
  if (largest == 0) return;
  const float scale = 1.0f / static_cast<float>(grid.step);
  // Places are counted from that of sample 0 at the largest disparity.
  const auto place = [&](int a) {
    return a + static_cast<int>((largest - disparity[a]) * scale + 0.5f);
  };
  owner->assign(
      static_cast<size_t>(grid.width) + static_cast<size_t>((largest - smallest) * scale) + 2, -1);
  for (int a = 0; a < grid.width; ++a) {
    if (disparity[a] <= 0) continue;
    int& holder = (*owner)[static_cast<size_t>(place(a))];
    if (holder < 0) {
      holder = a;
      continue;
    }
    const auto on_surface_of = [&](int other) {
      return std::abs(disparity[a] - disparity[other]) <= tolerance;
    };
    // On a steep surface many samples in a row fall on one place: each agrees with the one before.
    const bool continues = disparity[a - 1] > 0 && place(a - 1) == place(a) && on_surface_of(a - 1);
    const bool same_surface = continues || on_surface_of(holder);
    const int better = score[a] > score[holder] ? a : holder;
    if (!same_surface) Remove(row + static_cast<size_t>(better == a ? holder : a), partial);
    holder = better;
  }
}

template <typename Visit>
void ForEachOf8(const SampleGrid& grid, int a, int b, const Visit& visit) {
  for (int v = std::max(0, b - 1); v <= std::min(grid.height - 1, b + 1); ++v) {
    for (int u = std::max(0, a - 1); u <= std::min(grid.width - 1, a + 1); ++u) {
      if (u != a || v != b) {
        visit(static_cast<size_t>(v) * static_cast<size_t>(grid.width) + static_cast<size_t>(u),
              grid.PixelX(u), grid.PixelY(v));
      }
    }
  }
}

// What is reconstructed already counts as a neighbour, so that the rim of a new area stays.
void RemoveLoners(const Gate& gate, PartialDisparity* partial) {
  const SampleGrid& grid = partial->grid;
  const float tolerance = SurfaceTolerance(*partial);
  std::vector<size_t> loners;
  for (int b = 0; b < grid.height; ++b) {
    for (int a = 0; a < grid.width; ++a) {
      const size_t node =
          static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
      const float disparity = partial->disparity[node];
      if (disparity <= 0) continue;
      int agreeing = 0;
      ForEachOf8(grid, a, b, [&](size_t neighbor, int x, int y) {
        const float other = partial->disparity[neighbor];
        const bool same = other > 0 && std::abs(other - disparity) <= tolerance;
        if (same || gate.Holds(gate.Nodes().IndexAt(x, y), disparity)) ++agreeing;
      });
      if (agreeing < kMinAgreeing) loners.push_back(node);
    }
  }
  for (const size_t node : loners) Remove(node, partial);
}

void RemoveSpecks(const Gate& gate, PartialDisparity* partial) {
  const SampleGrid& grid = partial->grid;
  const float tolerance = SurfaceTolerance(*partial);
  std::vector<uint8_t> seen(grid.Size(), 0);
  std::vector<size_t> speck;
  for (size_t start = 0; start < grid.Size(); ++start) {
    if (seen[start] || partial->disparity[start] <= 0) continue;
    speck.assign(1, start);
    seen[start] = 1;
    int num_supporting = 0;
    for (size_t next = 0; next < speck.size(); ++next) {
      const size_t node = speck[next];
      const float disparity = partial->disparity[node];
      const int a = static_cast<int>(node) % grid.width, b = static_cast<int>(node) / grid.width;
      ForEachOf8(grid, a, b, [&](size_t neighbor, int x, int y) {
        if (gate.Holds(gate.Nodes().IndexAt(x, y), disparity)) ++num_supporting;
        const float other = partial->disparity[neighbor];
        if (seen[neighbor] || other <= 0 || std::abs(other - disparity) > tolerance) return;
        seen[neighbor] = 1;
        speck.push_back(neighbor);
      });
    }
    if (static_cast<int>(speck.size()) + num_supporting >= kMinSpeckSize) continue;
    for (const size_t node : speck) Remove(node, partial);
  }
}

}  // namespace

void RemoveInconsistent(const Gate& gate, PartialDisparity* nodes) {
  std::vector<int> owner;
  for (int b = 0; b < nodes->grid.height; ++b) RemoveDoubleClaims(b, nodes, &owner);
  RemoveLoners(gate, nodes);
  RemoveSpecks(gate, nodes);
}

void RemoveContradictions(const Gate& gate, int num_threads, PartialDisparity* samples) {
  const SampleGrid& grid = samples->grid;
  constexpr int kBand = 16;  // rows a task
  ParallelFor(num_threads, (grid.height + kBand - 1) / kBand, [&](int64_t band) {
    std::vector<int> owner;
    const int begin = static_cast<int>(band) * kBand, end = std::min(grid.height, begin + kBand);
    for (int b = begin; b < end; ++b) {
      const size_t row = static_cast<size_t>(b) * static_cast<size_t>(grid.width);
      for (int a = 0; a < grid.width; ++a) {
        const size_t sample = row + static_cast<size_t>(a);
        const float disparity = samples->disparity[sample];
        const size_t node = gate.Nodes().IndexAt(grid.PixelX(a), grid.PixelY(b));
        if (disparity <= 0 || gate.Admits(node, disparity)) continue;
        Remove(sample, samples);
      }
      RemoveDoubleClaims(b, samples, &owner);
    }
  });
}

void RemoveUnsure(const PairGeometry& geometry, float min_confidence, int num_threads,
                  PartialSurface* surface) {
  const SampleGrid& grid = surface->grid;
  ParallelFor(num_threads, grid.height, [&](int64_t b) {
    const size_t row = static_cast<size_t>(b) * static_cast<size_t>(grid.width);
    for (int a = 0; a < grid.width; ++a) {
      const size_t sample = row + static_cast<size_t>(a);
      float& disparity = surface->disparity[sample];
      if (disparity <= 0) continue;
      if (surface->support[sample] < kMinSupport ||
          !(surface->confidence[sample] >= min_confidence) ||
          geometry.SineOfParallax(grid.RectX(a), grid.RectY(static_cast<int>(b)), disparity) <
              kMinSineOfParallax) {
        disparity = 0;
      }
    }
  });
}

}  // namespace colmap_seapoint
