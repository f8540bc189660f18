#include "densify/cloud/disparity_to_cloud.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {

namespace {

const float* RowOf(const std::vector<float>& values, const SampleGrid& grid, int b) {
  return values.data() + static_cast<size_t>(b) * static_cast<size_t>(grid.width);
}

// The colour of the pixel that the place lies in, or of the nearest one.
std::array<uint8_t, 3> ColorNear(const Picture& picture, float x, float y) {
  return ColorAt(picture, std::clamp(static_cast<int>(x), 0, picture.luma.width - 1),
                 std::clamp(static_cast<int>(y), 0, picture.luma.height - 1));
}

// Whether a sample of the surface becomes a point: where the frame magnifies, not every one does.
class PointChoice {
 public:
  PointChoice(const PartialSurface& surface, const PairGeometry& geometry) : surface_(surface) {
    double passed = 0;  // points of a row up to here
    for (int a = 0; a < surface.grid.width; ++a) {
      const double spacing = geometry.SampleSpacing(surface.grid.RectX(a));
      columns_.push_back({spacing, std::floor(passed + 1 / spacing) > std::floor(passed)});
      passed += 1 / spacing;
    }
  }

  bool Holds(int a, int b) const {
    const Column& column = columns_[static_cast<size_t>(a)];
    return column.is_chosen && RowOf(surface_.disparity, surface_.grid, b)[a] > 0 &&
           std::floor((b + 1) / column.spacing) > std::floor(b / column.spacing);
  }

 private:
  struct Column {
    double spacing;  // between the samples of a column that become points
    bool is_chosen;
  };

  const PartialSurface& surface_;
  std::vector<Column> columns_;
};

// The points of one row of samples.
class RowToPoints {
 public:
  RowToPoints(const PartialSurface& surface, const PointChoice& choice,
              const PairGeometry& geometry, const RectMap& map1, const Picture& picture1)
      : surface_(surface),
        choice_(choice),
        geometry_(geometry),
        map1_(map1),
        picture1_(picture1),
        x_(static_cast<size_t>(surface.grid.window.width) + RectMap::kRowSlack),
        y_(x_.size()) {}

  void Run(int b, DensePoint* next) {
    const SampleGrid& grid = surface_.grid;
    int first = 0;
    while (first < grid.width && !choice_.Holds(first, b)) ++first;
    if (first == grid.width) return;
    map1_.SourceRow(grid.PixelY(b), 0, grid.window.width, x_.data(), y_.data());
    for (int a = first; a < grid.width; ++a) {
      if (choice_.Holds(a, b)) *next++ = PointOf(a, b);
    }
  }

 private:
  DensePoint PointOf(int a, int b) const {
    const SampleGrid& grid = surface_.grid;
    const double x = grid.RectX(a), y = grid.RectY(b), d = RowOf(surface_.disparity, grid, b)[a];
    const double slope_x = RowOf(surface_.slope_x, grid, b)[a];
    const double slope_y = RowOf(surface_.slope_y, grid, b)[a];
    const Eigen::Vector3d in_rect = geometry_.PointInRect(x, y, d);
    const bool has_normal = slope_x != 0 || slope_y != 0;
    const Eigen::Vector3d normal = has_normal ? geometry_.NormalInRect(x, y, d, slope_x, slope_y)
                                              : Eigen::Vector3d(-in_rect.normalized());
    const size_t pixel = static_cast<size_t>(grid.PixelX(a));
    return {(geometry_.world_from_rect * in_rect + geometry_.center1).cast<float>(),
            (geometry_.world_from_rect * normal).cast<float>(),
            ColorNear(picture1_, x_[pixel], y_[pixel]), RowOf(surface_.confidence, grid, b)[a]};
  }

  const PartialSurface& surface_;
  const PointChoice& choice_;
  const PairGeometry& geometry_;
  const RectMap& map1_;
  const Picture& picture1_;
  std::vector<float> x_, y_;
};

// The samples of a picture's cell.
struct CellSum {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // of the matched ones, rect frame
  int matched = 0, all = 0;
};

std::vector<CellSum> SumCells(const PartialSurface& surface, const PairGeometry& geometry,
                              const SampleGrid& nodes, const std::vector<int>& cell_of_node,
                              size_t num_cells) {
  const SampleGrid& grid = surface.grid;
  std::vector<CellSum> sums(num_cells);
  for (int b = 0; b < grid.height; ++b) {
    const float* row = RowOf(surface.disparity, grid, b);
    for (int a = 0; a < grid.width; ++a) {
      const int cell = cell_of_node[nodes.IndexAt(grid.PixelX(a), grid.PixelY(b))];
      if (cell < 0) continue;
      CellSum& sum = sums[static_cast<size_t>(cell)];
      ++sum.all;
      if (row[a] <= 0) continue;
      ++sum.matched;
      sum.point += geometry.PointInRect(grid.RectX(a), grid.RectY(b), row[a]);
    }
  }
  return sums;
}

}  // namespace

PartialCloud MakePartialCloud(const PartialSurface& surface, const PairGeometry& geometry,
                              const RectMap& map1, const Picture& picture1, int num_threads) {
  const SampleGrid& grid = surface.grid;
  const PointChoice choice(surface, geometry);
  std::vector<size_t> first_of_row(1, 0);
  for (int b = 0; b < grid.height; ++b) {
    size_t count = 0;
    for (int a = 0; a < grid.width; ++a) count += choice.Holds(a, b);
    first_of_row.push_back(first_of_row.back() + count);
  }
  PartialCloud cloud;
  cloud.points.resize(first_of_row.back());
  constexpr int kBand = 16;  // rows a task
  ParallelFor(num_threads, (grid.height + kBand - 1) / kBand, [&](int64_t band) {
    RowToPoints row_to_points(surface, choice, geometry, map1, picture1);
    const int begin = static_cast<int>(band) * kBand, end = std::min(grid.height, begin + kBand);
    for (int b = begin; b < end; ++b) {
      row_to_points.Run(b, cloud.points.data() + first_of_row[static_cast<size_t>(b)]);
    }
  });
  return cloud;
}

CellTally TallyCells(const PartialSurface& surface, const PairGeometry& geometry,
                     const SampleGrid& nodes, const std::vector<int>& cell_of_node,
                     const KnownCells& known) {
  const std::vector<CellSum> sums =
      SumCells(surface, geometry, nodes, cell_of_node, known.grid.Size());
  CellTally tally;
  tally.filled.assign(sums.size(), 0);
  for (size_t cell = 0; cell < sums.size(); ++cell) {
    const CellSum& sum = sums[cell];
    if (sum.matched == 0) continue;
    tally.filled[cell] = static_cast<float>(sum.matched) / static_cast<float>(sum.all);
    if (tally.filled[cell] < kMinCoveredCell || !known.IsNew(cell)) continue;
    const Eigen::Vector3d mean = sum.point / sum.matched;
    tally.footprint.patches.push_back(
        {(geometry.world_from_rect * mean + geometry.center1).cast<float>(),
         static_cast<float>(known.grid.cell * mean.norm() / geometry.camera1.MeanFocal())});
  }
  tally.footprint.UpdateSphere();
  return tally;
}

}  // namespace colmap_seapoint
