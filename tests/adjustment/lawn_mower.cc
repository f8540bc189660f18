#include "tests/adjustment/lawn_mower.h"

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>

#include "tests/mapping/exact_survey.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kSpacing = 0.4, kStripSpacing = 1.0;

// A rigid motion that bends what lies around a place of the plane.
Rigid3d BendAt(const Eigen::Vector2d& place, const Eigen::Vector2d& middle, double curvature) {
  const Eigen::Vector2d off = place - middle;
  const Eigen::Vector2d slope = curvature * off;
  const Eigen::Vector3d normal = Eigen::Vector3d(-slope.x(), -slope.y(), 1).normalized();
  Rigid3d bend;
  bend.rotation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal);
  const Eigen::Vector3d from(place.x(), place.y(), 0);
  const Eigen::Vector3d to(place.x(), place.y(), 0.5 * curvature * off.squaredNorm());
  bend.translation = to - bend.rotation * from;
  return bend;
}

}  // namespace

SparseModel LawnMower(int num_strips, int pictures_a_strip, int points_a_picture) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Camera camera = ExactLens();
  SparseModel model;
  model.cameras[1] = camera;
  for (int k = 0; k < num_strips * pictures_a_strip; ++k) {
    const int strip = k / pictures_a_strip, along = k % pictures_a_strip;
    const bool is_back = strip % 2 == 1;
    PosedImage image;
    image.image_id = static_cast<uint32_t>(k + 1);
    image.camera_id = 1;
    image.name = "img" + std::to_string(k + 1) + ".jpg";
    const Eigen::Vector3d center(kSpacing * (is_back ? pictures_a_strip - 1 - along : along),
                                 kStripSpacing * strip, 0.2 * uniform(random));
    const Eigen::Vector3d turn_deg(8 * uniform(random) - 4, 8 * uniform(random) - 4,
                                   is_back ? 178 : 2);
    image.cam_from_world = StandAt(camera, center, turn_deg).cam_from_world;
    model.images.push_back(image);
  }
  const double length = kSpacing * pictures_a_strip, width = kStripSpacing * num_strips;
  const double area_of_picture = 2.2 * 1.7;
  const auto num_points =
      static_cast<uint64_t>(points_a_picture * (length + 2) * (width + 1.5) / area_of_picture);
  for (uint64_t id = 1; id <= num_points; ++id) {
    SparsePoint point;
    point.xyz = {(length + 2) * uniform(random) - 1, (width + 1.5) * uniform(random) - 1,
                 2 - 0.4 * uniform(random)};
    for (int strip = 0; strip < num_strips; ++strip) {
      if (std::abs(point.xyz.y() - kStripSpacing * strip) > 1.5) continue;
      for (int step = -5; step <= 5; ++step) {
        int along = static_cast<int>(std::floor(point.xyz.x() / kSpacing)) + step;
        if (along < 0 || along >= pictures_a_strip) continue;
        if (strip % 2 == 1) along = pictures_a_strip - 1 - along;
        const auto idx = static_cast<size_t>(strip * pictures_a_strip + along);
        Observe(camera, id, &model.images[idx], &point);
      }
    }
    model.points3D[id] = point;
  }
  return model;
}

SparseModel Bent(SparseModel model, double depth) {
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const PosedImage& image : model.images) {
    const Eigen::Vector2d center = image.cam_from_world.OriginInSource().head<2>();
    low = low.cwiseMin(center);
    high = high.cwiseMax(center);
  }
  const Eigen::Vector2d middle = 0.5 * (low + high);
  const double curvature = 2 * depth / (high - middle).squaredNorm();
  for (PosedImage& image : model.images) {
    const Eigen::Vector2d center = image.cam_from_world.OriginInSource().head<2>();
    image.cam_from_world = image.cam_from_world * BendAt(center, middle, curvature).Inverse();
  }
  for (auto& [id, point] : model.points3D) {
    point.xyz = BendAt(point.xyz.head<2>(), middle, curvature) * point.xyz;
  }
  std::vector<double>& params = model.cameras.at(1).params;
  params[0] *= 1.01;
  params[1] *= 1.01;
  params[4] += 0.01;
  return model;
}

double CentersRms(const SparseModel& model, const SparseModel& truth) {
  const auto count = static_cast<Eigen::Index>(model.images.size());
  Eigen::Matrix3Xd a(3, count), b(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    a.col(i) = model.images[static_cast<size_t>(i)].cam_from_world.OriginInSource();
    b.col(i) = truth.images[static_cast<size_t>(i)].cam_from_world.OriginInSource();
  }
  const Eigen::Matrix4d similarity = Eigen::umeyama(a, b);
  const Eigen::Matrix3Xd moved =
      (similarity.topLeftCorner<3, 3>() * a).colwise() + similarity.topRightCorner<3, 1>();
  return std::sqrt((moved - b).colwise().squaredNorm().mean());
}

}  // namespace colmap_seapoint
