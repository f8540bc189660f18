#include "colmap_seapoint/page/cloud_sample.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace colmap_seapoint {
namespace {

TEST(PointChooser, AsManyAsWantedSpreadEvenly) {
  const PointChooser all(1000, 2000), some(1000000, 30000);
  int num_all = 0, num_first = 0, num_last = 0;
  for (uint64_t i = 0; i < 1000; ++i) num_all += all.Takes(i) ? 1 : 0;
  EXPECT_EQ(num_all, 1000);
  for (uint64_t i = 0; i < 500000; ++i) {
    num_first += some.Takes(i) ? 1 : 0;
    num_last += some.Takes(500000 + i) ? 1 : 0;
  }
  EXPECT_NEAR(num_first, 15000, 500);
  EXPECT_NEAR(num_last, 15000, 500);
}

uint16_t CodeAt(const PackedCloud& cloud, size_t index) {
  return static_cast<uint16_t>(cloud.codes[2 * index] | cloud.codes[2 * index + 1] << 8);
}

TEST(PackCloud, PlacesComeBackInThePlan) {
  Eigen::Matrix3d turn;  // map x = world z
  turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  std::vector<ColoredPoint> points;
  for (int i = 0; i <= 500; ++i) {
    points.push_back({Eigen::Vector3d(0.1 * i, 7 + 0.01 * (i % 10), 1000.5 + 0.2 * i),
                      {static_cast<uint8_t>(i % 256), 2, 3}});
  }
  const PackedCloud cloud = PackCloud(points, turn);
  const size_t count = cloud.colors.size() / 3;  // one, the last of 501, may be taken for a stray
  ASSERT_GE(count, 500u);
  ASSERT_EQ(cloud.codes.size(), 6 * count);
  for (size_t i = 0; i < count; ++i) {
    EXPECT_EQ(cloud.colors[3 * i], i % 256);
    const Eigen::Vector3d place = turn * points[i].xyz;
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<Eigen::Index>(axis);
      const double read = cloud.low[k] + cloud.step * CodeAt(cloud, 3 * i + axis);
      EXPECT_NEAR(read, place[k], 0.51 * cloud.step);
    }
  }
  EXPECT_LT(cloud.step, 0.002);  // of 100 units
}

TEST(PackCloud, AStrayPointDoesNotMakeTheRestCoarse) {
  std::vector<ColoredPoint> points;
  for (int i = 0; i < 5000; ++i) points.push_back({{0.001 * i, 0.002 * i, 0}, {1, 2, 3}});
  points[17].xyz = {1e6, 0, 0};
  const PackedCloud cloud = PackCloud(points, Eigen::Matrix3d::Identity());
  EXPECT_LT(cloud.step, 1e-3);
  EXPECT_GE(cloud.colors.size() / 3, 4950u);
  EXPECT_LT(cloud.colors.size() / 3, 5000u);
  EXPECT_TRUE(PackCloud({}, Eigen::Matrix3d::Identity()).codes.empty());
}

}  // namespace
}  // namespace colmap_seapoint
