#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "densify/completeness/gaps/gap_regions.h"
#include "densify/completeness/gaps/merge_gaps.h"
#include "densify/completeness/outline.h"
#include "densify/completeness/surface/asked_area.h"
#include "densify/completeness/surface/plan_frame.h"
#include "densify/completeness/surface/plane_pyramid.h"
#include "densify/completeness/surface/tiled_grid.h"
#include "densify/completeness/survey_limits.h"

namespace colmap_seapoint {
namespace {

TEST(TiledGrid, NegativeCellsHaveTilesOfTheirOwn) {
  TiledGrid<int> grid;
  for (int x = -40; x <= 40; x += 8) grid.At(x, -x) = x;
  for (int x = -40; x <= 40; x += 8) EXPECT_EQ(*grid.Find(x, -x), x);
  EXPECT_EQ(grid.Find(1000, 1000), nullptr);
  int sum = 0, count = 0;
  grid.ForEach([&](int x, int y, int value) {
    sum += value;
    if (value != 0) {
      ++count;
      EXPECT_EQ(x, value);
      EXPECT_EQ(y, -value);
    }
  });
  EXPECT_EQ(sum, 0);
  EXPECT_EQ(count, 10);
}

TEST(PlanePyramid, PlaneThroughAHole) {
  PlanePyramid pyramid(0.1);
  const auto height = [](double u, double v) { return 2 + 0.3 * u - 0.2 * v; };
  for (double v = 0; v < 10; v += 0.05) {
    for (double u = 0; u < 10; u += 0.05) {
      if (std::hypot(u - 5, v - 5) > 2) pyramid.Add(u, v, height(u, v), 1);
    }
  }
  pyramid.Finish();
  for (const auto& [u, v] : {std::pair{5.0, 5.0}, {4.0, 6.0}, {1.0, 9.0}, {10.3, 5.0}}) {
    const PlaneAt plane = pyramid.At(u, v);
    EXPECT_NEAR(plane.height, height(u, v), 0.02) << u << " " << v;
    EXPECT_NEAR(plane.slope.x(), 0.3, 0.02);
    EXPECT_NEAR(plane.slope.y(), -0.2, 0.02);
  }
  EXPECT_EQ(PlanePyramid(1).At(3, 4).height, 0);
}

TEST(PlanFrame, SidesAreRightHanded) {
  for (int i = 0; i < kNumSides; ++i) {
    const Eigen::Matrix3d side = SideFromMap(static_cast<Side>(i));
    EXPECT_NEAR(side.determinant(), 1, 1e-12);
    EXPECT_TRUE((side * side.transpose()).isIdentity(1e-12));
    // A normal towards the viewer of a side belongs to it.
    EXPECT_EQ(SideOf(side.row(2).transpose()), static_cast<Side>(i));
  }
  EXPECT_EQ(SideOf(Eigen::Vector3d::Zero()), Side::kTop);
  EXPECT_EQ(SideOf({0.9, 0, 0.4}), Side::kTop);
  EXPECT_EQ(SideOf({0.99, 0, 0.1}), Side::kRight);
}

TEST(AskedArea, HolesAndCrossings) {
  const Ring square = {{0, 0}, {4, 0}, {4, 4}, {0, 4}}, hole = {{1, 1}, {2, 1}, {2, 2}, {1, 2}};
  const AskedArea area{{square, hole}};
  EXPECT_TRUE(area.Contains({3, 3}));
  EXPECT_FALSE(area.Contains({1.5, 1.5}));
  EXPECT_FALSE(area.Contains({5, 1}));
  EXPECT_FALSE(CrossesItself(square));
  EXPECT_TRUE(CrossesItself({{0, 0}, {4, 4}, {4, 0}, {0, 4}}));
  EXPECT_DOUBLE_EQ(SignedArea(square), 16);
  // 17 with the hole, twice.
  EXPECT_FALSE(area.IsTooLarge(std::sqrt(18 / kMaxAskedCells)));
  EXPECT_TRUE(area.IsTooLarge(std::sqrt(16 / kMaxAskedCells)));
  // Small, but far off.
  const double far = 2 * kMaxAskedCells;
  EXPECT_TRUE((AskedArea{{{{far, 0}, {far + 1, 0}, {far, 1}}}}.IsTooLarge(1)));
}

using Cells = std::vector<std::pair<int, int>>;

double AreaOfRings(const std::vector<Ring>& rings) {
  double area = 0;
  for (const Ring& ring : rings) area += SignedArea(ring);
  return area;
}

TEST(TraceCells, RingWithHole) {
  Cells cells;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) {
      if (x != 2 || y != 2) cells.emplace_back(x, y);
    }
  }
  const std::vector<Ring> rings = TraceCells(cells);
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_EQ(rings[0].size(), 4u);
  EXPECT_DOUBLE_EQ(SignedArea(rings[0]), 20);
  EXPECT_DOUBLE_EQ(SignedArea(rings[1]), -1);
}

TEST(TraceCells, CornersThatTouchStayApart) {
  const std::vector<Ring> rings = TraceCells({{0, 0}, {1, 1}});
  ASSERT_EQ(rings.size(), 2u);
  for (const Ring& ring : rings) EXPECT_DOUBLE_EQ(SignedArea(ring), 1);
}

TEST(TraceCells, AnyShapeKeepsItsAreaAndItsCells) {
  uint32_t random = 1;
  for (int round = 0; round < 50; ++round) {
    Cells cells;
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 12; ++x) {
        random = random * 1664525u + 1013904223u;
        if ((random >> 16) % 3 != 0) cells.emplace_back(x, y);
      }
    }
    const std::vector<Ring> rings = TraceCells(cells);
    EXPECT_DOUBLE_EQ(AreaOfRings(rings), static_cast<double>(cells.size()));
    const AskedArea area{rings};
    const std::set<std::pair<int, int>> in(cells.begin(), cells.end());
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 12; ++x) {
        EXPECT_EQ(area.Contains({x + 0.5, y + 0.5}), in.count({x, y}) > 0);
      }
    }
  }
}

GapRegion Square(int x0, int y0, int side, GapCause cause) {
  GapRegion region;
  region.cause = cause;
  for (int y = y0; y < y0 + side; ++y) {
    for (int x = x0; x < x0 + side; ++x) region.cells.emplace_back(x, y);
  }
  region.area = side * side;
  region.rings = TraceCells(region.cells);
  return region;
}

TEST(MergeIntoPasses, WhatOnePassPhotographsIsOneGap) {
  PassPlan plan;
  plan.across = plan.along = 40;  // cells; a hundredth of a picture: 16
  const std::vector<GapRegion> regions = {
      Square(0, 0, 10, GapCause::kImagedOnce),
      Square(14, 0, 5, GapCause::kImagedOnce),    // within half a picture of the first
      Square(0, 14, 5, GapCause::kNoTexture),     // another cause: a gap of its own
      Square(0, 33, 3, GapCause::kNoTexture),     // a speck beside a larger one of its cause
      Square(-6, 0, 3, GapCause::kOccluded),      // a speck beside one of another cause
      Square(200, 0, 3, GapCause::kImagedOnce),   // a speck far from all
      Square(300, 0, 50, GapCause::kImagedOnce),  // larger than a picture, both
      Square(352, 0, 45, GapCause::kImagedOnce),
  };
  const PassRegions merged = MergeIntoPasses(regions, plan, 1);
  EXPECT_DOUBLE_EQ(merged.unlisted_area, 9);
  ASSERT_EQ(merged.regions.size(), 4u);
  EXPECT_DOUBLE_EQ(merged.regions[0].area, 2500);
  EXPECT_DOUBLE_EQ(merged.regions[1].area, 2025);
  EXPECT_DOUBLE_EQ(merged.regions[2].area, 100 + 25 + 9);
  EXPECT_EQ(merged.regions[2].rings.size(), 3u);
  EXPECT_DOUBLE_EQ(AreaOfRings(merged.regions[2].rings), 100 + 25 + 9);
  EXPECT_DOUBLE_EQ(merged.regions[3].area, 25 + 9);
  EXPECT_EQ(merged.regions[3].cause, GapCause::kNoTexture);
}

TEST(LeaveOutBackground, WhatAllPicturesSeeFromFarAway) {
  Ground ground;
  GroundLayer& top = ground.LayerAt({Side::kTop, 0});
  for (int y = 0; y < 64; ++y) {  // the farther the larger y: a GSD of 2 at 30
    for (int x = 0; x < 64; ++x) {
      GroundCell& cell = top.cells.At(x, y);
      cell.is_expected = true;
      cell.gsd = static_cast<float>(0.5 + 0.05 * y);
      cell.is_covered = x == 7;
      cell.cause = cell.is_covered ? GapCause::kNone : GapCause::kImagedOnce;
    }
  }
  LeaveOutBackground(1, &ground);
  EXPECT_TRUE(top.cells.Find(5, 29)->is_expected);
  EXPECT_FALSE(top.cells.Find(5, 32)->is_expected);
  EXPECT_EQ(top.cells.Find(5, 32)->cause, GapCause::kImagedOnce);
  EXPECT_TRUE(top.cells.Find(7, 60)->is_expected);
}

TEST(JudgeUnseen, AnEnclosedSlitIsAHoleAndANotchIsNone) {
  Ground ground;
  GroundLayer& top = ground.LayerAt({Side::kTop, 0});
  const auto is_slit = [](int x, int y) { return x >= 200 && x < 214 && y >= 100 && y < 300; };
  const auto is_notch = [](int x, int y) { return x >= 90 && x < 110 && y < 20; };
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) {
      if (is_slit(x, y) || is_notch(x, y)) continue;
      GroundCell& cell = top.cells.At(x, y);
      cell.is_expected = true;
      cell.gsd = 1;
    }
  }
  top.surface.Add(200, 200, 0, 1);
  top.surface.Finish();
  JudgeUnseen({300, 2}, nullptr, LostSight({}, {}, 1), &ground);
  for (int y = 104; y < 296; ++y) {
    EXPECT_EQ(top.cells.Find(207, y)->cause, GapCause::kNeverImaged) << y;
  }
  EXPECT_FALSE(top.cells.Find(100, 5)->is_expected);
}

TEST(LeaveOutIslands, WhatIsFarFromTheSurveyAndHardlyCovered) {
  Ground ground;
  GroundLayer& top = ground.LayerAt({Side::kTop, 0});
  // From x0 on: so many columns of 100 rows, of which the first ones are covered.
  const auto add = [&](int x0, int num_columns, int num_covered) {
    for (int y = 0; y < 100; ++y) {
      for (int x = x0; x < x0 + num_columns; ++x) {
        GroundCell& cell = top.cells.At(x, y);
        cell.is_expected = true;
        cell.is_covered = x < x0 + num_covered;
        cell.area = 1;
      }
    }
  };
  add(0, 100, 20);   // the survey itself
  add(320, 60, 10);  // an island
  add(640, 60, 30);  // an island that is a part of it
  LeaveOutIslands(&ground);
  EXPECT_TRUE(top.cells.Find(90, 50)->is_expected);
  EXPECT_FALSE(top.cells.Find(370, 50)->is_expected);
  EXPECT_TRUE(top.cells.Find(322, 50)->is_expected);
  EXPECT_TRUE(top.cells.Find(690, 50)->is_expected);
}

// Faces of any steepness lie evenly; heights by chance do not.
TEST(FinishPoints, SteepFacesAreSurfacesAndChanceIsNone) {
  const auto covered_share = [](const auto& height) {
    Ground ground;
    ground.cell_side = 2;
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 80; ++x) {
        // As many as lie on the face, where it is steep.
        for (int k = 0; k < 4; ++k) {
          AddPoint({{x + 0.125 + 0.25 * k, y + 0.5, height(x + 0.125 + 0.25 * k, y + 0.5)},
                    Eigen::Vector3d::UnitZ()},
                   &ground);
        }
      }
    }
    FinishPoints(1, &ground);
    int num_covered = 0;
    ground.LayerAt({Side::kTop, 0}).cells.ForEach([&](int x, int y, const GroundCell& cell) {
      if (x > 0 && y > 0 && x < 39 && y < 39) num_covered += cell.is_covered ? 1 : 0;
    });
    return num_covered / (38.0 * 38.0);
  };
  EXPECT_EQ(covered_share([](double, double) { return 0.0; }), 1);
  EXPECT_EQ(covered_share([](double x, double) { return 3 * x; }), 1);
  const auto chance = [](double x, double y) {  // one height a cell
    uint32_t h = static_cast<uint32_t>(x / 2) * 7919u + static_cast<uint32_t>(y / 2) * 104729u;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return 100.0 * (h >> 16) / 65536;
  };
  EXPECT_LT(covered_share(chance), 0.05);
}

TEST(ReliableTexture, NineTenthsOfTheBest) {
  Ground ground;
  GroundLayer& top = ground.LayerAt({Side::kTop, 0});
  for (int y = 0; y < 64; ++y) {  // texture 10 + y: below 30 every second cell is missing
    for (int x = 0; x < 64; ++x) {
      GroundCell& cell = top.cells.At(x, y);
      cell.is_expected = cell.has_pair = true;
      cell.area = 1;
      cell.texture = static_cast<uint8_t>(10 + y);
      cell.is_covered = cell.is_from_afar = y >= 20 || x % 2 == 0;
      if (!cell.is_covered) cell.cause = GapCause::kViewsDisagree;
    }
  }
  top.cells.At(1, 50).is_covered = false;
  top.cells.At(1, 50).cause = GapCause::kViewsDisagree;
  EXPECT_NEAR(ReliableTexture(ground), 30, 3);
  TellWhatLacksTexture(&ground);
  EXPECT_EQ(top.cells.Find(1, 5)->cause, GapCause::kNoTexture);
  EXPECT_EQ(top.cells.Find(1, 50)->cause, GapCause::kViewsDisagree);
}

}  // namespace
}  // namespace colmap_seapoint
