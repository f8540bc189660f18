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

// The points of one row of samples.
class RowToPoints {
 public:
  RowToPoints(const PartialSurface& surface, const PairGeometry& geometry, const RectMap& map1,
              const Picture& picture1)
      : surface_(surface),
        map1_(map1),
        picture1_(picture1),
        focal_(static_cast<float>(geometry.focal)),
        focal_baseline_(static_cast<float>(geometry.focal * geometry.baseline)),
        world_from_rect_(geometry.world_from_rect.cast<float>()),
        center1_(geometry.center1),
        x_(static_cast<size_t>(surface.grid.window.width) + RectMap::kRowSlack),
        y_(x_.size()) {}

  void Run(int b, DensePoint* next) {
    const SampleGrid& grid = surface_.grid;
    const float* disparity = RowOf(surface_.disparity, grid, b);
    const float* slope_x = RowOf(surface_.slope_x, grid, b);
    const float* slope_y = RowOf(surface_.slope_y, grid, b);
    int first = 0;
    while (first < grid.width && disparity[first] <= 0) ++first;
    if (first == grid.width) return;
    map1_.SourceRow(grid.PixelY(b), 0, grid.window.width, x_.data(), y_.data());
    const float rect_y = static_cast<float>(grid.RectY(b));
    for (int a = first; a < grid.width; ++a) {
      const float d = disparity[a];
      if (d <= 0) continue;
      const float rect_x = static_cast<float>(grid.RectX(a));
      const Eigen::Vector3f ray =
          world_from_rect_ * Eigen::Vector3f(rect_x / focal_, rect_y / focal_, 1);
      DensePoint& point = *next++;
      point.xyz = (center1_ + (focal_baseline_ / d * ray).cast<double>()).cast<float>();
      point.normal = Normal(rect_x, rect_y, d, slope_x[a], slope_y[a], ray);
      const size_t pixel = static_cast<size_t>(grid.PixelX(a));
      point.rgb = ColorNear(picture1_, x_[pixel], y_[pixel]);
    }
  }

 private:
  // Rect points lie at (x, y, f) B / d. Where d = c + p x + q y (x, y in rect pixels), d X = B x
  // etc. give the plane n . X = const with n ~ (p, q, (d - p x - q y) / f): the surface's normal.
  Eigen::Vector3f Normal(float x, float y, float d, float p, float q,
                         const Eigen::Vector3f& ray) const {
    if (p == 0 && q == 0) return -ray.normalized();
    const Eigen::Vector3f normal =
        world_from_rect_ * Eigen::Vector3f(p, q, (d - p * x - q * y) / focal_).normalized();
    return normal.dot(ray) > 0 ? Eigen::Vector3f(-normal) : normal;
  }

  const PartialSurface& surface_;
  const RectMap& map1_;
  const Picture& picture1_;
  const float focal_, focal_baseline_;
  const Eigen::Matrix3f world_from_rect_;
  const Eigen::Vector3d center1_;
  std::vector<float> x_, y_;
};

// The samples of a picture's cell.
struct CellSum {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();  // (x, y, 1) / disparity: linear in the place
  int matched = 0, all = 0;
};

std::vector<CellSum> SumCells(const PartialSurface& surface, const SampleGrid& nodes,
                              const std::vector<int>& cell_of_node, size_t num_cells) {
  const SampleGrid& grid = surface.grid;
  std::vector<CellSum> sums(num_cells);
  for (int b = 0; b < grid.height; ++b) {
    const float* row = RowOf(surface.disparity, grid, b);
    const float y = static_cast<float>(grid.RectY(b));
    for (int a = 0; a < grid.width; ++a) {
      const int cell = cell_of_node[nodes.IndexAt(grid.PixelX(a), grid.PixelY(b))];
      if (cell < 0) continue;
      CellSum& sum = sums[static_cast<size_t>(cell)];
      ++sum.all;
      if (row[a] <= 0) continue;
      ++sum.matched;
      sum.point += Eigen::Vector3f(static_cast<float>(grid.RectX(a)), y, 1) / row[a];
    }
  }
  return sums;
}

}  // namespace

PartialCloud MakePartialCloud(const PartialSurface& surface, const PairGeometry& geometry,
                              const RectMap& map1, const Picture& picture1, int num_threads) {
  const SampleGrid& grid = surface.grid;
  std::vector<size_t> first_of_row(static_cast<size_t>(grid.height) + 1, 0);
  for (int b = 0; b < grid.height; ++b) {
    const float* row = RowOf(surface.disparity, grid, b);
    first_of_row[static_cast<size_t>(b) + 1] =
        first_of_row[static_cast<size_t>(b)] +
        static_cast<size_t>(std::count_if(row, row + grid.width, [](float d) { return d > 0; }));
  }
  PartialCloud cloud;
  cloud.points.resize(first_of_row.back());
  constexpr int kBand = 16;  // rows a task
  ParallelFor(num_threads, (grid.height + kBand - 1) / kBand, [&](int64_t band) {
    RowToPoints row_to_points(surface, geometry, map1, picture1);
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
  const std::vector<CellSum> sums = SumCells(surface, nodes, cell_of_node, known.grid.Size());
  CellTally tally;
  tally.filled.assign(sums.size(), 0);
  for (size_t cell = 0; cell < sums.size(); ++cell) {
    const CellSum& sum = sums[cell];
    if (sum.matched == 0) continue;
    tally.filled[cell] = static_cast<float>(sum.matched) / static_cast<float>(sum.all);
    if (tally.filled[cell] < kMinCoveredCell || !known.IsNew(cell)) continue;
    const Eigen::Vector3d mean = sum.point.cast<double>() / sum.matched;
    const Eigen::Vector3d center =
        geometry.PointInWorld(mean.x() / mean.z(), mean.y() / mean.z(), 1 / mean.z());
    const double range = (center - geometry.center1).norm();
    tally.footprint.patches.push_back(
        {center.cast<float>(), static_cast<float>(known.grid.cell * range / geometry.focal)});
  }
  tally.footprint.UpdateSphere();
  return tally;
}

}  // namespace colmap_seapoint
