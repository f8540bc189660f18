#include "colmap_seapoint/compare/cell_measures.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

int64_t CellIndex(double position) { return static_cast<int64_t>(std::floor(position)); }

using Counts = CellMap<CellCounts>;

void Count(double squared, const std::vector<double>& limits, CellCounts* cell) {
  ++cell->num_points;
  for (size_t k = 0; k < limits.size(); ++k) cell->num_within[k] += squared <= limits[k];
}

// Whether the rectangle about `place` that a cell takes in the plan lies in the box.
bool IsInside(const PlanBox& box, const Eigen::Array2d& place, const Eigen::Array2d& half) {
  return (place - half >= box.low).all() && (place + half <= box.high).all();
}

template <typename PlaceOf>
CellLayer Split(const Counts& counts, const PointTiles& cloud, int tile, size_t num_distances,
                const Eigen::Array2d& half, PlaceOf place_of) {
  CellLayer layer;
  for (const auto& [key, cell] : counts.Items()) {
    if (IsInside(cloud.Partition().Box(tile), place_of(key), half)) {
      layer.whole.Add(cell, num_distances);
    } else {
      layer.at_border[key] = cell;
    }
  }
  return layer;
}

CellLayer MeasureVoxels(const PointTiles& cloud, int tile, const PointVector& points,
                        const std::vector<double>& squared, const std::vector<double>& limits,
                        double size, double shift) {
  Counts counts;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array3d at = points[i].array() / size + shift;
    Count(squared[i], limits, &counts[{CellIndex(at[0]), CellIndex(at[1]), CellIndex(at[2])}]);
  }
  const Eigen::Array2d half =
      0.5 * size * cloud.View().axes.topRows<2>().cwiseAbs().rowwise().sum().array() +
      2 * cloud.Partition().Slack();
  return Split(counts, cloud, tile, limits.size(), half, [&](const CellKey& key) {
    const Eigen::Vector3d cell(static_cast<double>(key[0]), static_cast<double>(key[1]),
                               static_cast<double>(key[2]));
    return cloud.PlanOf(((cell.array() + 0.5 - shift) * size).matrix());
  });
}

CellLayer MeasurePlan(const PointTiles& cloud, int tile, const PointVector& points,
                      const std::vector<double>& squared, const std::vector<double>& limits,
                      double size) {
  Counts counts;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array2d at = cloud.PlanOf(points[i]) / size;
    Count(squared[i], limits, &counts[{CellIndex(at[0]), CellIndex(at[1]), 0}]);
  }
  const Eigen::Array2d half = Eigen::Array2d::Constant(0.5 * size + 2 * cloud.Partition().Slack());
  return Split(counts, cloud, tile, limits.size(), half, [size](const CellKey& key) {
    return Eigen::Array2d((static_cast<double>(key[0]) + 0.5) * size,
                          (static_cast<double>(key[1]) + 0.5) * size);
  });
}

}  // namespace

void CellSums::Add(const CellCounts& counts, size_t num_distances) {
  ++num_cells;
  for (size_t k = 0; k < num_distances; ++k) {
    shares[k] += static_cast<double>(counts.num_within[k]) / counts.num_points;
  }
}

void CellSums::Add(const CellSums& other) {
  num_cells += other.num_cells;
  for (size_t k = 0; k < shares.size(); ++k) shares[k] += other.shares[k];
}

void CellLayer::Merge(const CellLayer& tile) {
  whole.Add(tile.whole);
  for (const auto& [key, cell] : tile.at_border.Items()) {
    CellCounts& sum = at_border[key];
    sum.num_points += cell.num_points;
    for (size_t k = 0; k < sum.num_within.size(); ++k) sum.num_within[k] += cell.num_within[k];
  }
}

CellSums CellLayer::Finish(size_t num_distances) const {
  CellSums sums = whole;
  for (const auto& item : at_border.Items()) sums.Add(item.second, num_distances);
  return sums;
}

void CellLayers::Merge(const CellLayers& tile) {
  for (size_t i = 0; i < layers.size(); ++i) layers[i].Merge(tile.layers[i]);
}

CellLayers MeasureCells(const PointTiles& cloud, int tile, const PointVector& points,
                        const std::vector<double>& squared, const CloudComparison& setup) {
  std::vector<double> limits;
  for (const double distance : setup.distances) limits.push_back(distance * distance);
  CellLayers cells;
  cells.layers[CellLayers::kVoxels] =
      MeasureVoxels(cloud, tile, points, squared, limits, setup.voxel_size, 0);
  cells.layers[CellLayers::kShiftedVoxels] =
      MeasureVoxels(cloud, tile, points, squared, limits, setup.voxel_size, 0.5);
  cells.layers[CellLayers::kArea] =
      MeasurePlan(cloud, tile, points, squared, limits, setup.area_cell_size);
  cells.layers[CellLayers::kRedundancy] =
      MeasurePlan(cloud, tile, points, squared, {}, setup.cell_size);
  return cells;
}

void FinishCells(const CellLayers& cells, const CloudComparison& setup, OneWay* way) {
  const size_t num_distances = setup.distances.size();
  CellSums voxels = cells.layers[CellLayers::kVoxels].Finish(num_distances);
  voxels.Add(cells.layers[CellLayers::kShiftedVoxels].Finish(num_distances));
  const CellSums area = cells.layers[CellLayers::kArea].Finish(num_distances);
  way->num_voxels = voxels.num_cells;
  way->num_area_cells = area.num_cells;
  way->num_cells = cells.layers[CellLayers::kRedundancy].Finish(0).num_cells;
  const double cell_area = setup.area_cell_size * setup.area_cell_size;
  way->area = cell_area * static_cast<double>(area.num_cells);
  for (size_t k = 0; k < num_distances; ++k) {
    way->at[k].voxel_share = voxels.shares[k] / static_cast<double>(voxels.num_cells);
    way->at[k].far_area =
        cell_area * std::max(0.0, static_cast<double>(area.num_cells) - area.shares[k]);
  }
}

}  // namespace colmap_seapoint
