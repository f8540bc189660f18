#include "densify/match/surface_layers.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {

namespace {

constexpr int kMinNodes = 3;
// A sample beside the known nodes is predicted from one node farther, the rest of its window from
// as many more as it is wide.
constexpr int kRings = 2 + (tile::kMaxWindow / 2 + kMinNodeStep - 1) / kMinNodeStep;

bool& At(NodeMarks* marks, int u, int v) {
  return (*marks)[static_cast<size_t>(v)][static_cast<size_t>(u)];
}
bool At(const NodeMarks& marks, int u, int v) {
  return marks[static_cast<size_t>(v)][static_cast<size_t>(u)];
}
float& At(tile::Prediction* prediction, int u, int v) {
  return prediction->disparity[static_cast<size_t>(v)][static_cast<size_t>(u)];
}
float At(const tile::Prediction& prediction, int u, int v) {
  return prediction.disparity[static_cast<size_t>(v)][static_cast<size_t>(u)];
}

// What is known of a tile's nodes; node (u, v) is (first_a + u, first_b + v) of the grid.
struct TileNodes {
  tile::Prediction matched;  // 0 where nothing is
  NodeMarks open{};
  int nodes_x, nodes_y;
};

TileNodes NodesOf(const PartialDisparity& nodes, const Gate& gate, int tile_a, int tile_b) {
  TileNodes tile;
  tile.matched.node_step = nodes.grid.step;
  tile.nodes_x = tile.matched.NodesX();
  tile.nodes_y = tile.matched.NodesY();
  const int first_a = tile_a * (tile.nodes_x - 2) - 1, first_b = tile_b * (tile.nodes_y - 2) - 1;
  for (int v = 0; v < tile.nodes_y; ++v) {
    const int b = first_b + v;
    if (b < 0 || b >= nodes.grid.height) continue;
    for (int u = 0; u < tile.nodes_x; ++u) {
      const int a = first_a + u;
      if (a < 0 || a >= nodes.grid.width) continue;
      const size_t node =
          static_cast<size_t>(b) * static_cast<size_t>(nodes.grid.width) + static_cast<size_t>(a);
      At(&tile.matched, u, v) = nodes.disparity[node];
      At(&tile.open, u, v) = gate[node] != Gate::kClosed;
    }
  }
  return tile;
}

// Nodes that hang together with (u, v); marks them in `seen`. Returns their number.
int Gather(const TileNodes& tile, int u, int v, NodeMarks* seen, NodeMarks* layer) {
  const float tolerance = kMaxLayerSlope * static_cast<float>(tile.matched.node_step);
  std::array<std::array<int, 2>, tile::kNodesX * tile::kNodesY> stack;
  size_t size = 0;
  int count = 0;
  const auto push = [&](int x, int y) {
    At(seen, x, y) = At(layer, x, y) = true;
    stack[size++] = {x, y};
    ++count;
  };
  push(u, v);
  while (size > 0) {
    const auto [x, y] = stack[--size];
    const float here = At(tile.matched, x, y);
    constexpr int kAround[4][2] = {{0, -1}, {-1, 0}, {1, 0}, {0, 1}};
    for (const auto& step : kAround) {
      const int x2 = x + step[0], y2 = y + step[1];
      if (x2 < 0 || y2 < 0 || x2 >= tile.nodes_x || y2 >= tile.nodes_y) continue;
      const float there = At(tile.matched, x2, y2);
      if (there > 0 && !At(*seen, x2, y2) && std::abs(there - here) <= tolerance) push(x2, y2);
    }
  }
  return count;
}

// The mean of what the nodes beside (u, v) and their slopes expect there; false when none is known.
bool ContinueTo(int u, int v, const TileNodes& tile, const NodeMarks& known,
                tile::Prediction* surface) {
  float sum = 0;
  int count = 0;
  for (int y = std::max(0, v - 1); y <= std::min(tile.nodes_y - 1, v + 1); ++y) {
    for (int x = std::max(0, u - 1); x <= std::min(tile.nodes_x - 1, u + 1); ++x) {
      if (!At(known, x, y)) continue;
      float value = At(*surface, x, y);
      const int x2 = 2 * x - u, y2 = 2 * y - v;  // the node beyond
      if (x2 >= 0 && y2 >= 0 && x2 < tile.nodes_x && y2 < tile.nodes_y && At(known, x2, y2)) {
        value += value - At(*surface, x2, y2);
      }
      sum += value;
      ++count;
    }
  }
  if (count > 0) At(surface, u, v) = sum / static_cast<float>(count);
  return count > 0;
}

// Each ring of nodes around the known ones continues the slope of the ring before.
void Continue(const TileNodes& tile, NodeMarks known, tile::Prediction* surface) {
  std::array<std::array<int, 2>, tile::kNodesX * tile::kNodesY> unknown, ring;
  size_t num_unknown = 0;
  for (int v = 0; v < tile.nodes_y; ++v) {
    for (int u = 0; u < tile.nodes_x; ++u) {
      if (!At(known, u, v)) unknown[num_unknown++] = {u, v};
    }
  }
  for (int i = 0; i < kRings && num_unknown > 0; ++i) {
    size_t num_ring = 0, num_left = 0;
    for (size_t n = 0; n < num_unknown; ++n) {
      const auto [u, v] = unknown[n];
      (ContinueTo(u, v, tile, known, surface) ? ring[num_ring++] : unknown[num_left++]) = {u, v};
    }
    for (size_t n = 0; n < num_ring; ++n) At(&known, ring[n][0], ring[n][1]) = true;
    num_unknown = num_left;
  }
}

SurfaceLayer MakeLayer(const TileNodes& tile, const NodeMarks& nodes) {
  SurfaceLayer layer{tile.matched, {}, tile.nodes_x, tile.nodes_y, 0, 0};
  for (int v = 1; v + 1 < tile.nodes_y; ++v) {
    for (int u = 1; u + 1 < tile.nodes_x; ++u) {
      bool near = false;
      for (int y = v - 1; y <= v + 1; ++y) {
        for (int x = u - 1; x <= u + 1; ++x) near = near || At(nodes, x, y);
      }
      if (!near || !At(tile.open, u, v)) continue;
      At(&layer.near, u, v) = true;
      layer.u0 = std::min(layer.u0, u);
      layer.v0 = std::min(layer.v0, v);
      layer.u1 = std::max(layer.u1, u + 1);
      layer.v1 = std::max(layer.v1, v + 1);
    }
  }
  Continue(tile, nodes, &layer.surface);
  return layer;
}

}  // namespace

void ForEachLayer(const PartialDisparity& nodes, const Gate& gate, int tile_a, int tile_b,
                  const std::function<void(const SurfaceLayer&)>& visit) {
  const TileNodes tile = NodesOf(nodes, gate, tile_a, tile_b);
  NodeMarks seen{};
  for (int v = 0; v < tile.nodes_y; ++v) {
    for (int u = 0; u < tile.nodes_x; ++u) {
      if (At(tile.matched, u, v) <= 0 || At(seen, u, v)) continue;
      NodeMarks marks{};
      if (Gather(tile, u, v, &seen, &marks) < kMinNodes) continue;
      const SurfaceLayer layer = MakeLayer(tile, marks);
      if (layer.u1 > 0) visit(layer);
    }
  }
}

}  // namespace colmap_seapoint
