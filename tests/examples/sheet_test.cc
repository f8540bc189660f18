#include "examples/survey/scene/sheet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "examples/survey/scene/landmarks.h"
#include "examples/survey/scene/noise.h"
#include "examples/survey/scene/surface.h"

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;

double Random(int k, int axis, double min, double max) {
  return min + (max - min) * Uniform(Hash(23, k, axis));
}

// A tube of radius 1 about z, from -1 to 1, as a prism of `sides` sides.
Sheet MakeTube(int sides) {
  std::vector<Eigen::Vector3f> nodes;
  for (int j = 0; j <= 20; ++j) {
    for (int i = 0; i <= sides; ++i) {
      const double angle = 2 * kPi * (i % sides) / sides;
      nodes.emplace_back(
          Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.1 * j - 1).cast<float>());
    }
  }
  return Sheet(sides + 1, 21, std::move(nodes), 0.01);
}

LandmarkOptions SmallStatue() {
  LandmarkOptions options;
  options.cell = 0.02;
  return options;
}

TEST(SheetTest, RaysAndDistancesOfATube) {
  const int sides = 720;
  const Sheet tube = MakeTube(sides);
  const double sagitta = 1 - std::cos(kPi / sides);
  for (int k = 0; k < 300; ++k) {
    const double angle = Random(k, 0, 0, 2 * kPi), height = Random(k, 1, -0.9, 0.9);
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d up(0, 0, height);
    const auto hit = tube.IntersectRay(3 * out + up, -out, 0, 10);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 2, 2 * sagitta);  // the near side, not the far one at 4
    EXPECT_LT((tube.At(hit->lattice) - (3 - hit->t) * out - up).norm(), 1e-6);
    EXPECT_GT(tube.Normal(hit->lattice).dot(out), 0.999);
    const double radius = Random(k, 2, 0.8, 1.2);
    EXPECT_NEAR(tube.Distance(radius * out + up, 1), std::abs(radius - 1), 2 * sagitta);
    EXPECT_FALSE(tube.IntersectRay(3 * out + up, out, 0, 10));
    EXPECT_FALSE(tube.IntersectRay(3 * out + up, -out, 0, 1.9));
  }
  EXPECT_EQ(tube.Distance({0, 0, 0}, 0.5), 0.5);
  EXPECT_NEAR(tube.Distance({1, 0, 1.25}, 1), 0.25, 1e-6);
}

TEST(SheetTest, TheFirstHitAndTheNearestPlaceOfAStatueAreThoseOfAllItsTriangles) {
  const Sheet statue = MakeStatue(SmallStatue(), 0);
  // The oracle: every cell, one by one, as a sheet of its own.
  std::vector<Sheet> cells;
  for (int j = 0; j + 1 < statue.NumY(); ++j) {
    for (int i = 0; i + 1 < statue.NumX(); ++i) {
      const auto node = [&](int di, int dj) {
        return statue.Nodes()[static_cast<size_t>((j + dj) * statue.NumX() + i + di)];
      };
      cells.emplace_back(
          2, 2, std::vector<Eigen::Vector3f>{node(0, 0), node(1, 0), node(0, 1), node(1, 1)}, 0.02);
    }
  }
  int num_hits = 0;
  for (int k = 0; k < 100; ++k) {
    const double angle = Random(k, 0, 0, 2 * kPi);
    const Eigen::Vector3d origin(2 * std::cos(angle), 2 * std::sin(angle), Random(k, 1, 0, 2));
    const Eigen::Vector3d target(Random(k, 2, -.4, .4), Random(k, 3, -.4, .4),
                                 Random(k, 4, 0, 1.7));
    const auto hit = statue.IntersectRay(origin, target - origin, 0, 5);
    double first = 10, nearest = 0.3;
    for (const Sheet& cell : cells) {
      const auto of_cell = cell.IntersectRay(origin, target - origin, 0, 5);
      if (of_cell) first = std::min(first, of_cell->t);
      nearest = std::min(nearest, cell.Distance(target, 0.3));
    }
    ASSERT_EQ(hit.has_value(), first < 10) << k;
    if (hit) {
      EXPECT_NEAR(hit->t, first, 1e-12);
    }
    num_hits += hit.has_value();
    EXPECT_NEAR(statue.Distance(target, 0.3), nearest, 1e-12);
  }
  EXPECT_GT(num_hits, 40);
}

TEST(SheetTest, AStatueIsClosedAndOverhangs) {
  const Sheet statue = MakeStatue(SmallStatue(), 0.5);
  float top = 0;
  int num_overhanging = 0;
  for (int j = 0; j < statue.NumY(); ++j) {
    const auto node = [&](int i) {
      return statue.Nodes()[static_cast<size_t>(j * statue.NumX() + i)];
    };
    EXPECT_EQ(node(0), node(statue.NumX() - 1));
    top = std::max(top, node(0).z());
    for (int i = 0; i < statue.NumX(); ++i) {
      num_overhanging += statue.Normal(Eigen::Vector2d(i, j)).z() < -0.3;
    }
  }
  EXPECT_NEAR(top, 0.5 + 1.6, 0.05);
  EXPECT_GT(num_overhanging, statue.NumX() * statue.NumY() / 30);
  // A ray that enters leaves again: seen from inside there is a wall all around.
  for (int k = 0; k < 200; ++k) {
    const double angle = Random(k, 0, 0, 2 * kPi);
    const Eigen::Vector3d way(std::cos(angle), std::sin(angle), Random(k, 1, -0.2, 0.2));
    EXPECT_TRUE(statue.IntersectRay({0, 0, 1.3}, way, 0, 10)) << k;
  }
}

TEST(SurfaceTest, AWallIsTheTurnedGround) {
  const GridSpec grid{-50, -50, 101, 101, 0.01};
  Field heights;
  for (int j = 0; j < grid.ny; ++j) {
    for (int i = 0; i < grid.nx; ++i) heights.push_back(static_cast<float>(0.2 * grid.X(i)));
  }
  const HeightField ground(grid, heights);
  Rigid3d turn;
  turn.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitX()));
  turn.translation = {0.1, 0.2, 0.3};
  const Surface flat{HeightField(ground)}, wall(ground, turn, Sheet());
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d origin(Random(k, 0, -.1, .1), Random(k, 1, -.1, .1), 0.7);
    const Eigen::Vector3d way(Random(k, 2, -.3, .3), Random(k, 3, -.3, .3), -1);
    const auto on_flat = flat.Trace(origin, way, 0, 10);
    const auto on_wall = wall.Trace(turn * origin, turn.rotation * way, 0, 10);
    ASSERT_TRUE(on_flat && on_wall);
    EXPECT_NEAR(on_wall->t, on_flat->t, 1e-9);
    EXPECT_LT((on_wall->xyz - turn * on_flat->xyz).norm(), 1e-9);
    EXPECT_LT((on_wall->normal - turn.rotation * on_flat->normal).norm(), 1e-9);
    EXPECT_LT((on_wall->texture - on_flat->texture).norm(), 1e-9);
    EXPECT_NEAR(wall.Distance(turn * origin, 2), flat.Distance(origin, 2), 1e-9);
  }
}

TEST(SurfaceTest, TheObjectHidesTheGroundBehindIt) {
  const GridSpec grid{-200, -200, 401, 401, 0.02};
  const HeightField ground(grid, Field(grid.Size(), 0.0f));
  const Surface surface(ground, Rigid3d(), MakeStatue(SmallStatue(), 0));
  const Eigen::Vector3d origin(-2, 0, 1.4);
  const auto in_front = surface.Trace(origin, Eigen::Vector3d(2, 0, -0.5), 0, 10);
  ASSERT_TRUE(in_front);
  EXPECT_EQ(in_front->part, SurfacePart::kObject);
  const auto beside = surface.Trace(origin, Eigen::Vector3d(2, 2, -1), 0, 10);
  ASSERT_TRUE(beside);
  EXPECT_EQ(beside->part, SurfacePart::kGround);
  EXPECT_NEAR(beside->xyz.z(), 0, 1e-9);
  EXPECT_NEAR(surface.Distance({2, 2, 0.1}, 1), 0.1, 1e-9);
  EXPECT_LT(surface.Distance(in_front->xyz, 1), 1e-9);
}

}  // namespace
}  // namespace colmap_seapoint
