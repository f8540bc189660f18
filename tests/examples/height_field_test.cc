#include "examples/survey/scene/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "examples/survey/scene/seabed.h"

namespace colmap_seapoint {
namespace {

HeightField MakePlane(double slope_x, double slope_y) {
  const GridSpec grid{-50, -50, 101, 101, 0.01};
  Field heights;
  for (int j = 0; j < grid.ny; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      heights.push_back(static_cast<float>(slope_x * grid.X(i) + slope_y * grid.Y(j)));
    }
  }
  return HeightField(grid, heights);
}

HeightField MakeRough(double relief) {
  const Seabed seabed({5, relief, 0.01});
  return MakeHeightField(seabed, -1, -1, 1, 1, 1);
}

double Random(int k, int axis, double min, double max) {
  return min + (max - min) * Uniform(Hash(17, k, axis));
}

TEST(HeightFieldTest, RayMeetsPlaneWhereItShould) {
  const HeightField plane = MakePlane(0.3, -0.2);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d origin(Random(k, 0, -.1, .1), Random(k, 1, -.1, .1), 0.7);
    const Eigen::Vector3d ray(Random(k, 2, -.3, .3), Random(k, 3, -.3, .3), -1);
    const auto t = plane.IntersectRay(origin, ray, 0, 10);
    const Eigen::Vector3d normal(-0.3, 0.2, 1);
    ASSERT_TRUE(t);
    EXPECT_NEAR(*t, -normal.dot(origin) / normal.dot(ray), 1e-6);
  }
}

TEST(HeightFieldTest, RayFindsTheFirstOfManyHits) {
  const HeightField field = MakeRough(1.5);
  int num_hits = 0;
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector3d origin(Random(k, 0, -.9, .9), Random(k, 1, -.9, .9), 1.0);
    const Eigen::Vector3d ray(Random(k, 2, -1.5, 1.5), Random(k, 3, -1.5, 1.5), -1);
    const auto t = field.IntersectRay(origin, ray, 0, 10);
    // The oracle: very small steps.
    double first = -1;
    for (double s = 0; s < 2.5 && first < 0; s += 2e-5) {
      const Eigen::Vector3d p = origin + s * ray;
      if (!field.Grid().Contains(p.x(), p.y())) break;
      if (p.z() <= field.Height(p.x(), p.y())) first = s;
    }
    ASSERT_EQ(first >= 0, t.has_value()) << k;
    if (!t) continue;
    ++num_hits;
    EXPECT_LE(*t, first + 1e-9);
    EXPECT_NEAR(*t, first, 3e-5);
  }
  EXPECT_GT(num_hits, 100);
}

TEST(HeightFieldTest, DistanceToTiltedPlane) {
  const HeightField plane = MakePlane(1.5, 0.5);
  const Eigen::Vector3d normal = Eigen::Vector3d(-1.5, -0.5, 1).normalized();
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector3d foot(Random(k, 0, -.2, .2), Random(k, 1, -.2, .2), 0);
    const double distance = Random(k, 2, -0.1, 0.1);
    const Eigen::Vector3d point =
        Eigen::Vector3d(foot.x(), foot.y(), 1.5 * foot.x() + 0.5 * foot.y()) + distance * normal;
    EXPECT_NEAR(plane.Distance(point, 1.0), std::abs(distance), 1e-6);
  }
  EXPECT_EQ(plane.Distance({0, 0, 0.5}, 0.01), 0.01);
  EXPECT_EQ(plane.Distance({100, 100, 0}, 0.05), 0.05);
}

TEST(HeightFieldTest, DistanceMatchesBruteForceOnRoughGround) {
  const HeightField field = MakeRough(1.5);
  for (int k = 0; k < 60; ++k) {
    const double x = Random(k, 0, -.6, .6), y = Random(k, 1, -.6, .6);
    const Eigen::Vector3d point(x, y, field.Height(x, y) + Random(k, 2, -.06, .06));
    double expected = 1;
    const double reach = std::abs(point.z() - field.Height(x, y));
    const double step = reach / 150 + 1e-5;
    for (double v = y - reach; v <= y + reach; v += step) {
      for (double u = x - reach; u <= x + reach; u += step) {
        expected = std::min(expected, (point - Eigen::Vector3d(u, v, field.Height(u, v))).norm());
      }
    }
    const double distance = field.Distance(point, 1.0);
    EXPECT_LE(distance, expected + 1e-7) << k;
    EXPECT_GT(distance, expected - 0.03 * reach - 1e-4) << k;
  }
}

TEST(HeightFieldTest, PointBesideALedgeIsNearItsFace) {
  const GridSpec grid{0, 0, 41, 41, 0.01};
  Field heights;
  for (int j = 0; j < grid.ny; ++j) {
    for (int i = 0; i < grid.nx; ++i) heights.push_back(i <= 20 ? 0.0f : 0.3f);
  }
  const HeightField ledge(grid, heights);
  // 4 mm in front of the foot of a face that rises 0.3 over one cell (0.20 ... 0.21).
  const double expected = (0.004 + 0.01 * 0.15 / 0.3) * 0.3 / std::hypot(0.3, 0.01);
  EXPECT_NEAR(ledge.Distance({0.196, 0.2, 0.15}, 1), expected, 1e-6);
  EXPECT_NEAR(ledge.Distance({0.1, 0.2, 0.02}, 1), 0.02, 1e-7);
}

TEST(SeabedTest, BlocksAndThreadsDoNotShow) {
  const Seabed seabed({3, 1.0, 0.004});
  const HeightField one = MakeHeightField(seabed, -1, -1, 1.5, 1.2, 1);
  const HeightField two = MakeHeightField(seabed, -1, -1, 1.5, 1.2, 2);
  EXPECT_EQ(one.Heights(), two.Heights());
  // Another rectangle, the same place: the same height.
  const HeightField part = MakeHeightField(seabed, 0.3, -0.2, 0.7, 0.4, 1);
  for (int k = 0; k < 100; ++k) {
    const double x = Random(k, 0, .31, .69), y = Random(k, 1, -.19, .39);
    EXPECT_NEAR(part.Height(x, y), one.Height(x, y), 1e-9);
  }
}

TEST(SeabedTest, AlbedoIsOneContinuousMap) {
  const Seabed seabed({3, 1.0, 0.004});
  AlbedoMap map(seabed, -1, -1, 1.5, 1.2, size_t{1} << 20);  // holds three tiles: many are dropped
  map.Prepare(0, 0, 0.4, 0.4, 2);
  const Albedo before = map.At(0.2, 0.3);
  map.Prepare(-1, -1, 1.5, 1.2, 2);
  map.Prepare(0.9, 0.9, 1, 1, 1);
  EXPECT_ANY_THROW(map.At(-0.9, -0.9));
  map.Prepare(0.1, 0.1, 1.2, 0.4, 1);
  const Albedo after = map.At(0.2, 0.3);
  EXPECT_EQ(before.red, after.red);
  EXPECT_EQ(before.blue, after.blue);
  // No jump anywhere, tile borders included (every 0.512 m).
  for (double x = 0.1; x < 1.2; x += 1e-4) {
    EXPECT_NEAR(map.At(x, 0.25).green, map.At(x + 1e-6, 0.25).green, 2e-3) << x;
  }
}

}  // namespace
}  // namespace colmap_seapoint
