#include "colmap_seapoint/compare/plan_view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "colmap_seapoint/compare/point_tiles.h"

namespace colmap_seapoint {
namespace {

// 8 x 4 x 0.5, turned.
PointVector TurnedSlab(const Eigen::Matrix3d& turn, int count) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  PointVector points;
  for (int i = 0; i < count; ++i) {
    points.push_back(turn *
                         Eigen::Vector3d(4 * unit(random), 2 * unit(random), .25 * unit(random)) +
                     Eigen::Vector3d(1000, 0, -5));
  }
  return points;
}

TEST(PlanView, FindsTheAxesOfASlabInSpiteOfAFarPoint) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  PointVector points = TurnedSlab(turn, 20000);
  points.emplace_back(1e6, 1e6, 1e6);
  for (const double side : {1.0, -1.0}) {
    const PlanView view = FitPlanView(points, {}, side * turn.col(2));
    EXPECT_GT(std::abs(view.axes.row(0).dot(turn.col(0))), 0.999);
    EXPECT_GT(std::abs(view.axes.row(1).dot(turn.col(1))), 0.999);
    EXPECT_GT(side * view.axes.row(2).dot(turn.col(2)), 0.999);
    // Right, down, up: as a picture of what lies below.
    EXPECT_NEAR(view.axes.determinant(), -1, 1e-9);
    EXPECT_NEAR(view.high[0] - view.low[0], 8, 0.1);
    EXPECT_NEAR(view.high[1] - view.low[1], 4, 0.1);
  }
}

TEST(PlanView, DoesNotDependOnTheOrderOfTheClouds) {
  const PointVector all = TurnedSlab(Eigen::Matrix3d::Identity(), 3000);
  const PointVector a(all.begin(), all.begin() + 1000), b(all.begin() + 1000, all.end());
  const PlanView ab = FitPlanView(a, b, Eigen::Vector3d::Zero());
  const PlanView ba = FitPlanView(b, a, Eigen::Vector3d::Zero());
  EXPECT_EQ(ab.axes, ba.axes);
  EXPECT_EQ(ab.center, ba.center);
}

TEST(PlanPicture, ShowsTheHighestPointWhereItIs) {
  PlanView view;
  view.axes.row(1) = -Eigen::Vector3d::UnitY().transpose();  // y points up in the picture
  view.low = Eigen::Array3d(0, -10, 0);
  view.high = Eigen::Array3d(10, 0, 1);
  PlanPicture picture(view, 101, 1000);
  ASSERT_EQ(picture.Picture().width, 101);
  ASSERT_EQ(picture.Picture().height, 101);
  picture.Add({2.05, 9.55, 0.5}, {1, 2, 3});
  picture.Add({2.05, 9.55, 0.4}, {9, 9, 9});  // below
  picture.Add({-2.0, 9.55, 0.4}, {9, 9, 9});  // outside
  int num_lit = 0;
  for (int y = 0; y < 101; ++y) {
    for (int x = 0; x < 101; ++x) num_lit += picture.Picture().At(x, y, 0) != 0;
  }
  EXPECT_EQ(num_lit, 1);
  EXPECT_EQ(picture.Picture().At(20, 4, 2), 3);
}

TEST(RampColor, GoesFromBlueToRed) {
  EXPECT_GT(RampColor(0)[2], RampColor(0)[0]);
  EXPECT_GT(RampColor(1)[0], RampColor(1)[2]);
  EXPECT_EQ(RampColor(7), RampColor(1));
}

}  // namespace
}  // namespace colmap_seapoint
