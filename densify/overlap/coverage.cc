#include "densify/overlap/coverage.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {

namespace {

// Patches of one cell belong to one surface when the farther one is no farther than this much.
constexpr float kOneSurface = 1.15f;

// A cone around the optical axis that holds the picture.
struct ViewCone {
  bool is_all = false;          // for pictures that see more than 80 degrees aside
  double sine = 0, cosine = 0;  // of its half-angle

  // Whether a sphere reaches into it. Asked for every footprint of the survey, for every picture,
  // and for every patch of those that it holds for: no more than a square root.
  bool Touches(const Eigen::Vector3d& center, double radius) const {
    if (is_all) return true;
    const double aside = center.head<2>().norm();
    if (center.squaredNorm() <= radius * radius) return true;
    // Along and away from the straight line of the cone that is nearest to the sphere's centre.
    const double along = aside * sine + center.z() * cosine;
    const double away = aside * cosine - center.z() * sine;
    return along >= 0 && away <= radius;
  }
};

ViewCone ViewConeOf(const Camera& camera) {
  double angle = 0;
  for (const double x : {0.0, static_cast<double>(camera.width)}) {
    for (const double y : {0.0, static_cast<double>(camera.height)}) {
      const auto ray = camera.CamFromImg({x, y});
      if (!ray) return {true};
      angle = std::max(angle, std::atan(ray->norm()));
    }
  }
  if (angle > 80 * M_PI / 180) return {true};
  return {false, std::sin(1.05 * angle), std::cos(1.05 * angle)};
}

void MarkPatch(const Eigen::Vector3d& in_cam, const SurfacePatch& patch, const Camera& camera,
               ViewCoverage* coverage) {
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
      float& far = coverage->far[static_cast<size_t>(b) * static_cast<size_t>(grid.width) +
                                 static_cast<size_t>(a)];
      if (range == 0 || candidate < range) {
        far = std::max(candidate, far <= kOneSurface * candidate ? far : 0);
        range = candidate;
      } else if (candidate <= kOneSurface * range) {
        far = std::max(far, candidate);
      }
    }
  }
}

}  // namespace

double ViewCoverage::CoveredShare() const {
  const auto covered = std::count_if(range.begin(), range.end(), [](float r) { return r > 0; });
  return range.empty() ? 0 : static_cast<double>(covered) / static_cast<double>(range.size());
}

ViewCoverage ProjectCoverage(const std::vector<PackedFootprint>& footprints, const Camera& camera,
                             const Rigid3d& cam_from_world, const CellGrid& grid) {
  ViewCoverage coverage{grid, std::vector<float>(grid.Size(), 0)};
  const ViewCone cone = ViewConeOf(camera);
  for (const PackedFootprint& footprint : footprints) {
    const Eigen::Vector3d center = cam_from_world * footprint.Center().cast<double>();
    if (footprint.NumPatches() == 0 || !cone.Touches(center, footprint.Radius())) continue;
    AddCoverage(footprint, camera, cam_from_world, &coverage);
  }
  return coverage;
}

void AddCoverage(const PackedFootprint& footprint, const Camera& camera,
                 const Rigid3d& cam_from_world, ViewCoverage* coverage) {
  const ViewCone cone = ViewConeOf(camera);
  const Eigen::Matrix3d rotation = cam_from_world.rotation.toRotationMatrix();
  footprint.ForEach([&](const SurfacePatch& patch) {
    const Eigen::Vector3d in_cam =
        rotation * patch.center.cast<double>() + cam_from_world.translation;
    if (cone.Touches(in_cam, patch.size)) MarkPatch(in_cam, patch, camera, coverage);
  });
}

}  // namespace colmap_seapoint
