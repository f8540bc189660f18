#include "densify/match/pair_geometry.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

// Two pictures of what lies about 3 ahead of the first one.
struct Motion {
  std::string name;
  Viewpoint view1, view2;
  RectSurface surface;
};

Viewpoint Ahead(const Eigen::Vector3d& center, const Eigen::Vector3d& turn_deg = {0, 0, 0}) {
  return StandAt(MakeCamera(CameraModel::kPinhole, 500, 640, 480), center, turn_deg);
}

Viewpoint Wide(const Eigen::Vector3d& center, const Eigen::Vector3d& turn_deg = {0, 0, 0}) {
  // 75 degrees aside at the left and right rims.
  return StandAt(MakeCamera(CameraModel::kSimpleFisheye, 320 / 1.309, 640, 480), center, turn_deg);
}

std::vector<Motion> Motions() {
  using S = RectSurface;
  return {
      {"aside", Ahead({0, 0, 0}), Ahead({0.5, 0, 0}), S::kPlane},
      {"aside, a little forward", Ahead({0, 0, 0}), Ahead({0.5, 0, 0.1}), S::kPlane},
      {"forward", Ahead({0, 0, 0}), Ahead({0, 0, 0.5}), S::kMercator},
      {"forward and aside", Ahead({0, 0, 0}), Ahead({0.1, 0.05, 0.5}), S::kMercator},
      {"backward", Ahead({0, 0, 0}), Ahead({0, 0, -0.5}), S::kMercator},
      {"three times nearer", Ahead({0, 0, 0}), Ahead({0.2, 0, 2}), S::kMercator},
      {"epipole at the rim", Ahead({0, 0, 0}), Ahead({0.3, 0, 0.5}), S::kMercator},
      {"down along a swim", Ahead({0, 0, 0}, {30, 0, 0}), Ahead({0, 0, 0.4}, {28, 3, 2}),
       S::kMercator},
      {"rolled over", Ahead({0, 0, 0}), Ahead({0.1, 0, 0.5}, {0, 0, 170}), S::kMercator},
      {"rolled aside", Ahead({0, 0, 0}), Ahead({0.5, 0, 0}, {0, 0, 90}), S::kPlane},
      {"around", Ahead({0, 0, 0}), Ahead({2.6, 0, 1.5}, {0, 60, 0}), S::kMercator},
      {"wide, aside", Wide({0, 0, 0}), Wide({0.5, 0, 0}), S::kMercator},
      {"wide, forward", Wide({0, 0, 0}), Wide({0, 0.1, 0.6}), S::kMercator},
  };
}

PairGeometry GeometryOf(const Motion& motion) {
  const auto geometry = MakePairGeometry(motion.view1.camera, motion.view1.cam_from_world,
                                         motion.view2.camera, motion.view2.cam_from_world);
  EXPECT_TRUE(geometry);
  return *geometry;
}

// A point that both cameras look at, and its two pixels.
struct SeenTwice {
  Eigen::Vector3d point;
  Eigen::Vector2d pixel1, pixel2;
};

std::vector<SeenTwice> PointsSeenTwice(const Motion& motion, int count) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<SeenTwice> points;
  for (int trial = 0; trial < 1000 * count && static_cast<int>(points.size()) < count; ++trial) {
    const Camera& camera = motion.view1.camera;
    const Eigen::Vector2d pixel1(unit(generator) * camera.width, unit(generator) * camera.height);
    const auto ray = camera.CamFromImg(pixel1);
    if (!ray) continue;
    const Eigen::Vector3d point = motion.view1.cam_from_world.Inverse() *
                                  (ray->homogeneous().normalized() * (2.6 + unit(generator)));
    const auto pixel2 = motion.view2.camera.ImgFromCam(motion.view2.cam_from_world * point);
    if (pixel2 && motion.view2.camera.InImage(*pixel2)) points.push_back({point, pixel1, *pixel2});
  }
  EXPECT_EQ(static_cast<int>(points.size()), count);
  return points;
}

TEST(PairGeometryTest, CoincidingCamerasHaveNone) {
  for (const double turn : {0.0, 20.0}) {
    const Viewpoint view1 = Ahead({1, 2, 3}), view2 = Ahead({1, 2, 3}, {0, turn, 0});
    EXPECT_FALSE(
        MakePairGeometry(view1.camera, view1.cam_from_world, view2.camera, view2.cam_from_world));
  }
}

TEST(PairGeometryTest, PointsLandOnEqualRowsAndComeBack) {
  for (const Motion& motion : Motions()) {
    SCOPED_TRACE(motion.name);
    const PairGeometry geometry = GeometryOf(motion);
    EXPECT_EQ(geometry.surface, motion.surface);
    EXPECT_NEAR(geometry.world_from_rect.determinant(), 1, 1e-12);
    for (const SeenTwice& seen : PointsSeenTwice(motion, 200)) {
      const auto rect1 = geometry.RectFromPixel1(seen.pixel1);
      const auto rect2 = geometry.RectFromPixel2(seen.pixel2);
      ASSERT_TRUE(rect1 && rect2);
      ASSERT_NEAR(rect1->y(), rect2->y(), 1e-6 * geometry.focal);
      const double disparity = rect1->x() - rect2->x();
      ASSERT_GT(disparity, 0);
      const Eigen::Vector3d found = geometry.PointInWorld(rect1->x(), rect1->y(), disparity);
      ASSERT_LT((found - seen.point).norm(), 1e-5);
      const double range = (seen.point - motion.view1.Center()).norm();
      ASSERT_NEAR(geometry.DisparityAtRange(rect1->x(), rect1->y(), range), disparity,
                  1e-4 * disparity);
      const double parallax =
          std::acos((seen.point - motion.view1.Center())
                        .normalized()
                        .dot((seen.point - motion.view2.Center()).normalized()));
      ASSERT_NEAR(geometry.SineOfParallax(rect1->x(), rect1->y(), disparity), std::sin(parallax),
                  1e-6);
      const auto range_at = [&](double d) {
        return geometry.PointInRect(rect1->x(), rect1->y(), d).norm();
      };
      const double h = 1e-4 * disparity;
      const double change = (range_at(disparity - h) - range_at(disparity + h)) / (2 * h);
      ASSERT_NEAR(geometry.RangePerDisparity(rect1->x(), disparity) * range_at(disparity) / change,
                  1, 1e-6);
    }
  }
}

// A plane through the point: its disparities around give back its normal.
TEST(PairGeometryTest, SlopesGiveTheNormal) {
  for (const Motion& motion : Motions()) {
    SCOPED_TRACE(motion.name);
    const PairGeometry geometry = GeometryOf(motion);
    const Eigen::Matrix3d rect_from_world = geometry.world_from_rect.transpose();
    for (const SeenTwice& seen : PointsSeenTwice(motion, 50)) {
      const Eigen::Vector3d in_rect = rect_from_world * (seen.point - geometry.center1);
      const Eigen::Vector3d normal =
          (-in_rect.normalized() + Eigen::Vector3d(0.3, -0.4, 0.2)).normalized();
      const Eigen::Vector2d at = *geometry.RectFromPixel1(seen.pixel1);
      const auto disparity_at = [&](double x, double y) {
        const Eigen::Vector3d ray = geometry.RayAt(x, y).normalized();
        return geometry.DisparityAtRange(x, y, normal.dot(in_rect) / normal.dot(ray));
      };
      const double h = 0.01;
      const double slope_x =
          (disparity_at(at.x() + h, at.y()) - disparity_at(at.x() - h, at.y())) / (2 * h);
      const double slope_y =
          (disparity_at(at.x(), at.y() + h) - disparity_at(at.x(), at.y() - h)) / (2 * h);
      const Eigen::Vector3d found =
          geometry.NormalInRect(at.x(), at.y(), disparity_at(at.x(), at.y()), slope_x, slope_y);
      ASSERT_LT((found - normal).norm(), 1e-3);
    }
  }
}

// What Mercator's map is for: a ball has the same size in both pictures although one camera is
// three times nearer.
TEST(PairGeometryTest, MercatorDrawsBothPicturesAtOneScale) {
  const Motion motion = Motions()[5];
  const PairGeometry geometry = GeometryOf(motion);
  const Eigen::Matrix3d rect_from_world = geometry.world_from_rect.transpose();
  for (const SeenTwice& seen : PointsSeenTwice(motion, 50)) {
    double size[2];
    for (const bool second : {false, true}) {
      const Eigen::Vector3d center = second ? motion.view2.Center() : motion.view1.Center();
      const Eigen::Vector3d in_rect = rect_from_world * (seen.point - center);
      const Eigen::Vector3d aside = in_rect.cross(Eigen::Vector3d::UnitX()).normalized();
      const auto place1 = geometry.RectFromRay(in_rect);
      const auto place2 = geometry.RectFromRay(in_rect + 1e-4 * aside.cross(in_rect).normalized());
      size[second] = (*place1 - *place2).norm();
    }
    EXPECT_NEAR(size[1] / size[0], 1, 1e-2);
  }
}

// Beside the epipole a pixel of the picture is drawn large; its samples are thinned as much.
TEST(PairGeometryTest, MagnificationGrowsTowardsTheEpipole) {
  const PairGeometry forward = GeometryOf(Motions()[2]);
  EXPECT_EQ(GeometryOf(Motions()[0]).Magnification(900), 1);
  double before = 0;
  for (const double pixel_x : {639.0, 500.0, 400.0, 350.0}) {
    const Eigen::Vector2d place = *forward.RectFromPixel1({pixel_x, 240});
    const Eigen::Vector2d beside = *forward.RectFromPixel1({pixel_x, 241});
    // Rows go around: one pixel down the picture is the map's own scale.
    EXPECT_NEAR((beside - place).norm(), forward.Magnification(place.x()),
                0.35 * forward.Magnification(place.x()));
    EXPECT_GT(forward.Magnification(place.x()), before);
    EXPECT_EQ(forward.SampleSpacing(place.x()), std::max(1.0, forward.Magnification(place.x())));
    before = forward.Magnification(place.x());
  }
}

}  // namespace
}  // namespace colmap_seapoint
