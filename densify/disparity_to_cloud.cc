#include "densify/disparity_to_cloud.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {

namespace {

constexpr int kNormalRadius = 2;      // samples around a point that its plane is fitted to
constexpr int kMinNormalSupport = 6;  // of them
constexpr float kMinFilledCell = 0.5f;

// Least squares of disparity = c + a u + b v around a sample, in samples; false when degenerate.
bool FitDisparityPlane(const PartialDisparity& partial, int a, int b, double* slope_x,
                       double* slope_y) {
  const SampleGrid& grid = partial.grid;
  const size_t node =
      static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
  const float center = partial.disparity[node];
  const float tolerance = 0.75f * static_cast<float>(kNormalRadius * std::max(1, grid.step));
  double n = 0, su = 0, sv = 0, suu = 0, suv = 0, svv = 0, sd = 0, sud = 0, svd = 0;
  for (int v = std::max(0, b - kNormalRadius); v <= std::min(grid.height - 1, b + kNormalRadius);
       ++v) {
    for (int u = std::max(0, a - kNormalRadius); u <= std::min(grid.width - 1, a + kNormalRadius);
         ++u) {
      const float disparity =
          partial.disparity[static_cast<size_t>(v) * static_cast<size_t>(grid.width) +
                            static_cast<size_t>(u)];
      if (disparity <= 0 || std::abs(disparity - center) > tolerance) continue;
      const double du = u - a, dv = v - b, d = disparity - center;
      n += 1;
      su += du;
      sv += dv;
      suu += du * du;
      suv += du * dv;
      svv += dv * dv;
      sd += d;
      sud += du * d;
      svd += dv * d;
    }
  }
  if (n < kMinNormalSupport) return false;
  const double uu = suu - su * su / n, uv = suv - su * sv / n, vv = svv - sv * sv / n;
  const double ud = sud - su * sd / n, vd = svd - sv * sd / n;
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-6)) return false;
  *slope_x = (vv * ud - uv * vd) / det / grid.step;
  *slope_y = (uu * vd - uv * ud) / det / grid.step;
  return true;
}

// Rect points lie at (x, y, f) B / d. Where d = c + p x + q y (x, y in rect pixels), d X = B x etc.
// give the plane n . X = const with n ~ (p, q, (d - p x - q y) / f): the surface's normal.
Eigen::Vector3d NormalInRect(const PartialDisparity& partial, const PairGeometry& geometry, int a,
                             int b) {
  const SampleGrid& grid = partial.grid;
  const double x = grid.RectX(a), y = grid.RectY(b);
  const Eigen::Vector3d ray = Eigen::Vector3d(x, y, geometry.focal).normalized();
  double p = 0, q = 0;
  if (!FitDisparityPlane(partial, a, b, &p, &q)) return -ray;
  const double d = partial.disparity[static_cast<size_t>(b) * static_cast<size_t>(grid.width) +
                                     static_cast<size_t>(a)];
  const Eigen::Vector3d normal =
      Eigen::Vector3d(p, q, (d - p * x - q * y) / geometry.focal).normalized();
  return normal.dot(ray) > 0 ? Eigen::Vector3d(-normal) : normal;
}

std::array<uint8_t, 3> ColorAt(const ColorImage& color, const Eigen::Vector2f& pixel) {
  const int x = std::clamp(static_cast<int>(pixel.x()), 0, color.width - 1);
  const int y = std::clamp(static_cast<int>(pixel.y()), 0, color.height - 1);
  return {color.At(x, y, 0), color.At(x, y, 1), color.At(x, y, 2)};
}

}  // namespace

PartialCloud MakePartialCloud(const PartialDisparity& partial, const PairGeometry& geometry,
                              const RectMap& map1, const ColorImage& color1, int num_threads) {
  const SampleGrid& grid = partial.grid;
  std::vector<size_t> first_of_row(static_cast<size_t>(grid.height) + 1, 0);
  for (int b = 0; b < grid.height; ++b) {
    const float* row =
        partial.disparity.data() + static_cast<size_t>(b) * static_cast<size_t>(grid.width);
    first_of_row[static_cast<size_t>(b) + 1] =
        first_of_row[static_cast<size_t>(b)] +
        static_cast<size_t>(std::count_if(row, row + grid.width, [](float d) { return d > 0; }));
  }
  PartialCloud cloud;
  cloud.points.resize(first_of_row.back());
  ParallelFor(num_threads, grid.height, [&](int64_t row) {
    const int b = static_cast<int>(row);
    size_t next = first_of_row[static_cast<size_t>(b)];
    for (int a = 0; a < grid.width; ++a) {
      const float disparity =
          partial.disparity[static_cast<size_t>(b) * static_cast<size_t>(grid.width) +
                            static_cast<size_t>(a)];
      if (disparity <= 0) continue;
      DensePoint& point = cloud.points[next++];
      point.xyz = geometry.PointInWorld(grid.RectX(a), grid.RectY(b), disparity).cast<float>();
      point.normal =
          (geometry.world_from_rect * NormalInRect(partial, geometry, a, b)).cast<float>();
      const auto source = map1.Source(grid.PixelX(a), grid.PixelY(b));
      point.rgb = source ? ColorAt(color1, *source) : std::array<uint8_t, 3>{0, 0, 0};
    }
  });
  return cloud;
}

CloudFootprint MakeFootprint(const PartialDisparity& partial, const PairGeometry& geometry,
                             const std::vector<int>& cell_of_sample,
                             const std::vector<float>& filled, const CellGrid& cells) {
  const SampleGrid& grid = partial.grid;
  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    int count = 0;
  };
  std::vector<Sum> sums(cells.Size());
  for (int b = 0; b < grid.height; ++b) {
    for (int a = 0; a < grid.width; ++a) {
      const size_t node =
          static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
      if (partial.disparity[node] <= 0 || cell_of_sample[node] < 0) continue;
      Sum& sum = sums[static_cast<size_t>(cell_of_sample[node])];
      sum.point += geometry.PointInWorld(grid.RectX(a), grid.RectY(b), partial.disparity[node]);
      ++sum.count;
    }
  }
  CloudFootprint footprint;
  for (size_t cell = 0; cell < sums.size(); ++cell) {
    if (filled[cell] < kMinFilledCell || sums[cell].count == 0) continue;
    const Eigen::Vector3d center = sums[cell].point / sums[cell].count;
    const double range = (center - geometry.center1).norm();
    footprint.patches.push_back(
        {center.cast<float>(), static_cast<float>(cells.cell * range / geometry.focal)});
  }
  footprint.UpdateSphere();
  return footprint;
}

}  // namespace colmap_seapoint
