#include "densify/completeness/surface/ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr double kHintWeight = 0.5;
constexpr double kMaxAreaFactor = 4;
// Of the 8 cells around: so many must lie within so many cells' sides in height.
constexpr int kMinAgreeing = 2;
constexpr double kMaxStep = 2;
// Or that many of the 4 pairs of opposite ones lie evenly on both sides of the cell.
constexpr int kMinEven = 3;

double Mean(double mean, double value, uint16_t count) { return mean + (value - mean) / count; }

LayerKey KeyOf(const Ground& ground, const SurfacePoint& point) {
  const Eigen::Matrix3d& map = ground.frame.map_from_world;
  const Side side = SideOf(map * point.normal);
  if (side == Side::kTop) return {side, 0};
  const double depth = (SideFromMap(side) * (map * point.xyz)).z();
  return {side, ground.CellOf(depth / kSlabCells)};
}

// The surface's slope at a cell from its neighbours' heights; zero where these are not known.
Eigen::Vector2d SlopeAt(const GroundLayer& layer, int x, int y, double side) {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    const int dx = axis == 0 ? 1 : 0, dy = 1 - dx;
    const GroundCell* a = layer.cells.Find(x - dx, y - dy);
    const GroundCell* b = layer.cells.Find(x + dx, y + dy);
    if (a == nullptr || b == nullptr || a->count == 0 || b->count == 0) continue;
    slope[axis] = (b->height - a->height) / (2 * side);
  }
  return slope;
}

// Whether a cell lies on one surface with its neighbours: what was matched by chance, of what moved
// or shows nothing, lies anywhere. Opposite neighbours on a steep face differ, but evenly.
bool IsCoherent(const GroundLayer& layer, int x, int y, const GroundCell& cell, double side) {
  double step[9];  // of the neighbours against the cell; NaN: no points
  int num_agreeing = 0, num_others = 0, num_even = 0;
  for (int k = 0; k < 9; ++k) {
    const GroundCell* next = layer.cells.Find(x + k % 3 - 1, y + k / 3 - 1);
    const bool has_points = next != nullptr && next->count > 0;
    step[k] = has_points ? next->height - cell.height : std::nan("");
    if (k == 4 || !has_points) continue;
    ++(std::abs(step[k]) <= kMaxStep * side ? num_agreeing : num_others);
  }
  for (int k = 0; k < 4; ++k) num_even += std::abs(step[k] + step[8 - k]) <= side ? 1 : 0;
  return (num_agreeing >= kMinAgreeing && num_agreeing >= num_others) || num_even >= kMinEven;
}

double AreaOf(const Eigen::Vector2d& slope, double side) {
  return side * side * std::min(kMaxAreaFactor, std::sqrt(1 + slope.squaredNorm()));
}

void FinishTile(const TileKey& key, double side, GroundLayer* layer) {
  constexpr int kSide = TiledGrid<GroundCell>::kSide;
  TiledGrid<GroundCell>::Tile& tile = layer->cells.ExistingTile(key);
  const double spacing = side / kCellSpacings;
  for (int i = 0; i < kSide * kSide; ++i) {
    GroundCell& cell = tile[static_cast<size_t>(i)];
    if (cell.count == 0) continue;
    const int x = key.x * kSide + i % kSide, y = key.y * kSide + i / kSide;
    cell.area = static_cast<float>(AreaOf(SlopeAt(*layer, x, y, side), side));
    const double wanted = WantedPoints(cell.area, spacing);
    const double share = std::max(cell.count / wanted, CountAround(*layer, x, y, 1) / (9 * wanted));
    cell.is_coherent = IsCoherent(*layer, x, y, cell, side);
    cell.is_covered = cell.is_coherent && share >= kCoveredShare;
    cell.is_thin = cell.is_coherent && !cell.is_covered && share >= kThinShare;
    cell.is_expected = cell.is_covered;
  }
}

}  // namespace

int CountAround(const GroundLayer& layer, int x, int y, int reach) {
  int count = 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const GroundCell* cell = layer.cells.Find(x + dx, y + dy);
      if (cell != nullptr) count += cell->count;
    }
  }
  return count;
}

double WantedPoints(double area, double spacing) { return area / (spacing * spacing); }

GroundLayer& Ground::LayerAt(const LayerKey& key) {
  const auto place = layers.find(key);
  if (place != layers.end()) return place->second;
  const Eigen::Matrix3d rotation = SideFromMap(key.side) * frame.map_from_world;
  return layers.try_emplace(key, rotation, cell_side).first->second;
}

int Ground::CellOf(double coordinate) const {
  // A point that far off belongs to no survey; it must not overflow.
  return static_cast<int>(std::clamp(std::floor(coordinate / cell_side), -1e9, 1e9));
}

Eigen::Vector3d Ground::PlaceOf(const GroundLayer& layer, int x, int y, double height) const {
  const Eigen::Vector3d place((x + 0.5) * cell_side, (y + 0.5) * cell_side, height);
  return layer.layer_from_world.transpose() * place;
}

void AddPoint(const SurfacePoint& point, Ground* ground) {
  GroundLayer& layer = ground->LayerAt(KeyOf(*ground, point));
  const Eigen::Vector3d place = layer.layer_from_world * point.xyz;
  GroundCell& cell = layer.cells.At(ground->CellOf(place.x()), ground->CellOf(place.y()));
  if (cell.count == UINT16_MAX) return;
  ++cell.count;
  cell.height = static_cast<float>(Mean(cell.height, place.z(), cell.count));
}

void AddHint(const Eigen::Vector3d& xyz, Ground* ground) {
  GroundLayer& layer = ground->LayerAt({Side::kTop, 0});
  const Eigen::Vector3d place = layer.layer_from_world * xyz;
  layer.surface.Add(place.x(), place.y(), place.z(), kHintWeight);
}

void FinishPoints(int num_threads, Ground* ground) {
  for (auto& [layer_key, layer] : ground->layers) {
    const std::vector<TileKey> keys = layer.cells.Keys();
    ParallelFor(num_threads, static_cast<int64_t>(keys.size()), [&, &layer = layer](int64_t i) {
      FinishTile(keys[static_cast<size_t>(i)], ground->cell_side, &layer);
    });
    layer.cells.ForEach([&, &layer = layer](int x, int y, GroundCell& cell) {
      if (!cell.is_coherent) return;
      layer.surface.Add((x + 0.5) * ground->cell_side, (y + 0.5) * ground->cell_side, cell.height,
                        cell.count);
    });
    layer.surface.Finish();
  }
}

void PredictCell(const Ground& ground, const GroundLayer& layer, int x, int y, GroundCell* cell) {
  const PlaneAt plane =
      layer.surface.At((x + 0.5) * ground.cell_side, (y + 0.5) * ground.cell_side);
  if (!cell->is_coherent) cell->height = static_cast<float>(plane.height);
  cell->area = static_cast<float>(AreaOf(plane.slope, ground.cell_side));
}

}  // namespace colmap_seapoint
