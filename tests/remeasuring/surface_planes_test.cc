#include "colmap_seapoint/remeasuring/surface_planes.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <vector>

namespace colmap_seapoint {
namespace {

// A grid of directions with some unsteadiness, onto a plane of the camera's frame.
std::vector<SeenPoint> OnPlane(const Eigen::Vector2d& slope, double noise) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  std::vector<SeenPoint> points;
  for (int y = -8; y <= 8; ++y) {
    for (int x = -8; x <= 8; ++x) {
      const Eigen::Vector2d direction =
          Eigen::Vector2d(x, y) / 20 + 0.01 * Eigen::Vector2d(normal(random), normal(random));
      points.push_back({direction, 0.5 + slope.dot(direction) + noise * normal(random)});
    }
  }
  return points;
}

std::vector<size_t> All(const std::vector<SeenPoint>& points) {
  std::vector<size_t> all(points.size());
  std::iota(all.begin(), all.end(), size_t{0});
  return all;
}

TEST(FitPlanes, FindsAPlane) {
  const Eigen::Vector2d slope(0.1, -0.2);
  const std::vector<SeenPoint> points = OnPlane(slope, 0);
  for (const SeenPlane& plane : FitPlanes(points, All(points))) {
    EXPECT_LT((plane.slope - slope).norm(), 0.02);
    const Eigen::Vector2d direction(0.1, 0.05);
    const Eigen::Vector3d place = *plane.At(plane.through.direction + direction);
    EXPECT_NEAR(1 / place.z(), plane.through.inverse_depth + slope.dot(direction), 0.003);
  }
}

TEST(FitPlanes, BarelyMindsWhatLiesOff) {
  const Eigen::Vector2d slope(0.1, -0.2);
  std::vector<SeenPoint> points = OnPlane(slope, 0.001);
  std::vector<size_t> wanted;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i % 4 == 0) {
      points[i].inverse_depth += 0.4;
    } else {
      wanted.push_back(i);
    }
  }
  double worst = 0, sum = 0;
  for (const SeenPlane& plane : FitPlanes(points, wanted)) {
    const double error = (plane.slope - slope).norm();
    worst = std::max(worst, error);
    sum += error;
  }
  EXPECT_LT(sum / static_cast<double>(wanted.size()), 0.04);
  EXPECT_LT(worst, 0.3);
}

TEST(FitPlanes, FacesTheCameraWhenNothingTells) {
  const std::vector<SeenPoint> few = {{{0, 0}, 0.5}, {{0.1, 0}, 0.6}, {{0, 0.1}, 0.6}};
  for (const SeenPlane& plane : FitPlanes(few, All(few))) {
    EXPECT_EQ(plane.slope, Eigen::Vector2d::Zero());
  }
  // As steep as no surface is seen.
  const std::vector<SeenPoint> steep = OnPlane({10, 0}, 0);
  for (const SeenPlane& plane : FitPlanes(steep, All(steep))) {
    EXPECT_EQ(plane.slope, Eigen::Vector2d::Zero());
  }
  // All in one place, and none at all.
  const std::vector<SeenPoint> same(30, SeenPoint{{0.1, 0.2}, 0.5});
  for (const SeenPlane& plane : FitPlanes(same, All(same))) {
    EXPECT_EQ(plane.slope, Eigen::Vector2d::Zero());
  }
  EXPECT_TRUE(FitPlanes({}, {}).empty());
}

}  // namespace
}  // namespace colmap_seapoint
