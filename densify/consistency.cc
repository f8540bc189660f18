#include <algorithm>
#include <cmath>

#include "densify/propagation.h"

namespace colmap_seapoint {

namespace {

constexpr float kMaxStep = 1.0f;   // disparity between neighbouring samples of one surface
constexpr int kMinAgreeing = 3;    // of a sample's 8 neighbours
constexpr int kMinSpeckSize = 30;  // samples

float SurfaceTolerance(const PartialDisparity& partial) {
  return kMaxStep * std::max(1.0f, 0.5f * static_cast<float>(partial.grid.step));
}

void Remove(size_t node, PartialDisparity* partial) {
  partial->disparity[node] = 0;
  partial->score[node] = -1;
}

// Two samples of one row that land on the same place of picture 2 at different disparities cannot
// both be right (one of them is occluded there): the better score stays.
void RemoveDoubleClaims(PartialDisparity* partial) {
  const SampleGrid& grid = partial->grid;
  const float tolerance = 1.0f + SurfaceTolerance(*partial);
  std::vector<int> owner;
  for (int b = 0; b < grid.height; ++b) {
    const size_t row = static_cast<size_t>(b) * static_cast<size_t>(grid.width);
    auto place = [&](size_t node, int a) {
      return static_cast<int>(std::lround((grid.PixelX(a) - partial->disparity[node]) / grid.step));
    };
    int low = 0, high = -1;
    for (int a = 0; a < grid.width; ++a) {
      const size_t node = row + static_cast<size_t>(a);
      if (partial->disparity[node] <= 0) continue;
      const int at = place(node, a);
      low = high < low ? at : std::min(low, at);
      high = std::max(high, at);
    }
    if (high < low) continue;
    owner.assign(static_cast<size_t>(high - low) + 1, -1);
    for (int a = 0; a < grid.width; ++a) {
      const size_t node = row + static_cast<size_t>(a);
      if (partial->disparity[node] <= 0) continue;
      int& holder = owner[static_cast<size_t>(place(node, a) - low)];
      if (holder < 0) {
        holder = a;
        continue;
      }
      const size_t other = row + static_cast<size_t>(holder);
      const bool same_surface =
          std::abs(partial->disparity[node] - partial->disparity[other]) <= tolerance;
      const bool better = partial->score[node] > partial->score[other];
      if (!same_surface) Remove(better ? other : node, partial);
      if (better) holder = a;
    }
  }
}

template <typename Visit>
void ForEachOf8(const SampleGrid& grid, int a, int b, const Visit& visit) {
  for (int v = std::max(0, b - 1); v <= std::min(grid.height - 1, b + 1); ++v) {
    for (int u = std::max(0, a - 1); u <= std::min(grid.width - 1, a + 1); ++u) {
      if (u != a || v != b) {
        visit(static_cast<size_t>(v) * static_cast<size_t>(grid.width) + static_cast<size_t>(u));
      }
    }
  }
}

// What is reconstructed already counts as a neighbour, so that the rim of a new area stays.
bool AgreesWithGate(float gate, float disparity) {
  return gate > 0 && !SampleGate::Admits(gate, disparity);
}

void RemoveLoners(const std::vector<float>& gate, PartialDisparity* partial) {
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
      ForEachOf8(grid, a, b, [&](size_t neighbor) {
        const float other = partial->disparity[neighbor];
        const bool same = other > 0 && std::abs(other - disparity) <= tolerance;
        if (same || AgreesWithGate(gate[neighbor], disparity)) ++agreeing;
      });
      if (agreeing < kMinAgreeing) loners.push_back(node);
    }
  }
  for (const size_t node : loners) Remove(node, partial);
}

void RemoveSpecks(const std::vector<float>& gate, PartialDisparity* partial) {
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
      ForEachOf8(grid, a, b, [&](size_t neighbor) {
        if (AgreesWithGate(gate[neighbor], disparity)) ++num_supporting;
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

void RemoveInconsistent(const std::vector<float>& gate, PartialDisparity* partial) {
  RemoveDoubleClaims(partial);
  RemoveLoners(gate, partial);
  RemoveSpecks(gate, partial);
}

}  // namespace colmap_seapoint
