#include "examples/benchmarks/densify/cloud_measures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

// n x n points a unit apart from (x, y) on, below and above zero.
void AddGrid(float x, float y, int n, int pair_idx, PairedCloud* cloud) {
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      cloud->points.push_back({x + static_cast<float>(i), y + static_cast<float>(j), 0.25f});
      cloud->pair_idx.push_back(pair_idx);
    }
  }
}

TEST(CloudMeasuresTest, LayersCountPairsNotPoints) {
  PairedCloud cloud;
  EXPECT_TRUE(std::isnan(MeanLayers(cloud, 4)));
  AddGrid(-7.5, -7.5, 16, 0, &cloud);
  EXPECT_EQ(MeanLayers(cloud, 4), 1);
  EXPECT_EQ(MeanLayers(cloud, 100), 1);
  AddGrid(-7.5, -7.5, 8, 1, &cloud);  // 4 of the 16 cubes of side 4 again
  EXPECT_EQ(MeanLayers(cloud, 4), 1.25);
  AddGrid(-7.25, -7.25, 8, 1, &cloud);  // the same pair once more
  EXPECT_EQ(MeanLayers(cloud, 4), 1.25);
}

TEST(CloudMeasuresTest, NearestPointAgainstBruteForce) {
  std::vector<Eigen::Vector3f> points;
  uint32_t state = 1;
  const auto random = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / 16777216.0f;
  };
  for (int i = 0; i < 500; ++i) points.push_back({random(), random(), random()});
  const NearestPoint nearest(points);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f place(random(), random(), random());
    float best = 10;
    for (const Eigen::Vector3f& point : points) best = std::min(best, (point - place).norm());
    EXPECT_NEAR(nearest.Distance(place), best, 1e-6);
  }
  EXPECT_TRUE(std::isinf(NearestPoint({}).Distance({0, 0, 0})));
}

TEST(CloudMeasuresTest, TwinsAreOnePlace) {
  const PointVector places = DistinctPlaces({{2, 0, 0}, {1, 5, 0}, {2, 0, 0}, {1, 4, 9}});
  EXPECT_EQ(places, (PointVector{{1, 4, 9}, {1, 5, 0}, {2, 0, 0}}));
  EXPECT_TRUE(DistinctPlaces({}).empty());
}

TEST(CloudMeasuresTest, ShareNear) {
  PairedCloud reference, cloud;
  AddGrid(0, 0, 10, 0, &reference);
  AddGrid(0, 0.5, 5, 0, &cloud);
  EXPECT_DOUBLE_EQ(ShareNear(reference.points, cloud.points, 0.5), 0.3);  // 5 x 6
  EXPECT_DOUBLE_EQ(ShareNear(reference.points, cloud.points, 0.4), 0);
  EXPECT_DOUBLE_EQ(ShareNear(reference.points, {}, 1), 0);
  EXPECT_TRUE(std::isnan(ShareNear({}, cloud.points, 1)));
}

}  // namespace
}  // namespace colmap_seapoint
