#include "densify/coverage.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {

namespace {

// Half-angle of a cone that holds the picture; pi for pictures that see more than 80 degrees aside.
double ViewConeAngle(const Camera& camera) {
  double angle = 0;
  for (const double x : {0.0, static_cast<double>(camera.width)}) {
    for (const double y : {0.0, static_cast<double>(camera.height)}) {
      const auto ray = camera.CamFromImg({x, y});
      if (!ray) return M_PI;
      angle = std::max(angle, std::atan(ray->norm()));
    }
  }
  return angle > 80 * M_PI / 180 ? M_PI : 1.05 * angle;
}

bool MayBeInView(const CloudFootprint& footprint, const Rigid3d& cam_from_world,
                 double cone_angle) {
  const Eigen::Vector3d center = cam_from_world * footprint.center.cast<double>();
  const double distance = center.norm();
  if (distance <= footprint.radius) return true;
  const double angle = std::acos(std::clamp(center.z() / distance, -1.0, 1.0));
  return angle <= cone_angle + std::asin(footprint.radius / distance);
}

void MarkPatch(const SurfacePatch& patch, const Camera& camera, const Rigid3d& cam_from_world,
               ViewCoverage* coverage) {
  const Eigen::Vector3d in_cam = cam_from_world * patch.center.cast<double>();
  const auto pixel = camera.ImgFromCam(in_cam);
  if (!pixel) return;
  const CellGrid& grid = coverage->grid;
  const double distance = in_cam.norm();
  // Cells whose centre lies inside the patch, a little grown so that turned patches leave no
  // cracks.
  const double half = 0.6 * patch.size * camera.MeanFocal() / distance;
  const int a0 = std::max(0, static_cast<int>(std::ceil((pixel->x() - half) / grid.cell - 0.5)));
  const int b0 = std::max(0, static_cast<int>(std::ceil((pixel->y() - half) / grid.cell - 0.5)));
  const int a1 =
      std::min(grid.width - 1, static_cast<int>(std::floor((pixel->x() + half) / grid.cell - 0.5)));
  const int b1 = std::min(grid.height - 1,
                          static_cast<int>(std::floor((pixel->y() + half) / grid.cell - 0.5)));
  for (int b = b0; b <= b1; ++b) {
    for (int a = a0; a <= a1; ++a) {
      float& range = coverage->range[static_cast<size_t>(b) * static_cast<size_t>(grid.width) +
                                     static_cast<size_t>(a)];
      const float candidate = static_cast<float>(distance);
      if (range == 0 || candidate < range) range = candidate;
    }
  }
}

}  // namespace

void CloudFootprint::UpdateSphere() {
  center.setZero();
  radius = 0;
  if (patches.empty()) return;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SurfacePatch& patch : patches) sum += patch.center.cast<double>();
  center = (sum / static_cast<double>(patches.size())).cast<float>();
  for (const SurfacePatch& patch : patches) {
    radius = std::max(radius, (patch.center - center).norm() + patch.size);
  }
}

double ViewCoverage::CoveredShare() const {
  const auto covered = std::count_if(range.begin(), range.end(), [](float r) { return r > 0; });
  return range.empty() ? 0 : static_cast<double>(covered) / static_cast<double>(range.size());
}

ViewCoverage ProjectCoverage(const std::vector<CloudFootprint>& footprints, const Camera& camera,
                             const Rigid3d& cam_from_world, const CellGrid& grid) {
  ViewCoverage coverage{grid, std::vector<float>(grid.Size(), 0)};
  const double cone_angle = ViewConeAngle(camera);
  for (const CloudFootprint& footprint : footprints) {
    if (footprint.patches.empty() || !MayBeInView(footprint, cam_from_world, cone_angle)) continue;
    AddCoverage(footprint, camera, cam_from_world, &coverage);
  }
  return coverage;
}

void AddCoverage(const CloudFootprint& footprint, const Camera& camera,
                 const Rigid3d& cam_from_world, ViewCoverage* coverage) {
  for (const SurfacePatch& patch : footprint.patches) {
    MarkPatch(patch, camera, cam_from_world, coverage);
  }
}

}  // namespace colmap_seapoint
