#include "colmap_seapoint/orthomosaic/relief/relief_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "colmap_seapoint/orthomosaic/ground/map_tile.h"
#include "colmap_seapoint/orthomosaic/relief/line_of_sight.h"

namespace colmap_seapoint {
namespace {

constexpr int kSide = 96;
const MapGrid::Box kBox = {1024, 2048, kSide, kSide};

// A height, in pixels, at a place of the tile; not a number: nothing there.
using Surface = std::function<double(double, double)>;

// Points `spacing` apart all over the tile and its halo, on a lattice that is turned against it.
std::vector<TilePoint> PointsOn(const Surface& surface, double spacing, double noise = 0) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  std::vector<TilePoint> points;
  const double c = std::cos(0.4), s = std::sin(0.4);
  for (double u = -300; u < 300; u += spacing) {
    for (double v = -300; v < 300; v += spacing) {
      const double x = c * u - s * v + 48, y = s * u + c * v + 48;
      const double low = -kTileHalo, high = kSide + kTileHalo;
      if (x < low || y < low || x >= high || y >= high) continue;
      const double height = surface(x, y) + noise * normal(random);
      if (std::isnan(height)) continue;
      points.push_back(
          {static_cast<float>(x), static_cast<float>(y), static_cast<float>(height), 1});
    }
  }
  return points;
}

ReliefTile Make(const std::vector<TilePoint>& points, int cell_size = 1, bool fill = false) {
  return MakeReliefTile({cell_size, 1, 0, fill}, points, kBox);
}

float HeightAt(const ReliefTile& tile, int x, int y) {
  return tile.heights.At(x + kReliefMargin, y + kReliefMargin);
}

// The share of pixels of the tile for which `is` holds.
double Share(const std::function<bool(int, int)>& is) {
  int count = 0;
  for (int i = 0; i < kSide * kSide; ++i) count += is(i % kSide, i / kSide);
  return static_cast<double>(count) / (kSide * kSide);
}

double Slope(double x, double y) { return 30 + 0.6 * x - 0.4 * y; }

TEST(ReliefTile, APlaneIsExactWhateverTheCells) {
  for (const int cell_size : {1, 2, 4, 8, 16}) {
    const ReliefTile tile = Make(PointsOn(Slope, 0.9 * cell_size), cell_size);
    double worst = 0;
    const double covered = Share([&](int x, int y) {
      if (tile.surface.At(x, y) == 0) return false;
      worst = std::max(worst, std::abs(double{HeightAt(tile, x, y)} - Slope(x + 0.5, y + 0.5)));
      return true;
    });
    EXPECT_EQ(covered, 1) << cell_size;
    EXPECT_LT(worst, 0.06 * cell_size) << cell_size;
  }
}

TEST(ReliefTile, NoiseIsAveragedAndConfidenceCounts) {
  std::vector<TilePoint> points = PointsOn(Slope, 0.8, 0.3);
  std::vector<double> errors;
  const auto measure = [&] {
    const ReliefTile tile = Make(points);
    errors.clear();
    for (int i = 0; i < kSide * kSide; ++i) {
      const int x = i % kSide, y = i / kSide;
      errors.push_back(std::abs(double{HeightAt(tile, x, y)} - Slope(x + 0.5, y + 0.5)));
    }
    std::sort(errors.begin(), errors.end());
    return errors[errors.size() / 2];
  };
  EXPECT_LT(measure(), 0.1);
  // Every second point is 1 too high, and known to be bad.
  for (size_t i = 0; i < points.size(); i += 2) {
    points[i].height += 1;
    points[i].weight = 0.02f;
  }
  EXPECT_LT(measure(), 0.2);
}

TEST(ReliefTile, AStepIsNotSmeared) {
  const auto step = [](double x, double) { return x < 48 ? 0.0 : 20.0; };
  const ReliefTile tile = Make(PointsOn(step, 0.7));
  for (int i = 0; i < kSide * kSide; ++i) {
    const int x = i % kSide, y = i / kSide;
    ASSERT_NE(tile.surface.At(x, y), 0);
    EXPECT_NEAR(HeightAt(tile, x, y), step(x + 0.5, 0), 0.01) << x << " " << y;
  }
}

TEST(ReliefTile, PointsInTheWaterAreNoSurface) {
  std::vector<TilePoint> points = PointsOn(Slope, 0.8);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> place(0, kSide), above(5, 50);
  for (int i = 0; i < 60; ++i) {
    const float x = place(random), y = place(random);
    points.push_back({x, y, static_cast<float>(Slope(double{x}, double{y})) + above(random), 1});
  }
  const ReliefTile tile = Make(points);
  for (int i = 0; i < kSide * kSide; ++i) {
    const int x = i % kSide, y = i / kSide;
    EXPECT_NEAR(HeightAt(tile, x, y), Slope(x + 0.5, y + 0.5), 0.3);
  }
}

TEST(ReliefTile, ATableIsTheSurfaceAndWhatLiesBelowIsSaid) {
  const auto is_table = [](double x, double y) { return x > 30 && x < 70 && y > 20 && y < 80; };
  std::vector<TilePoint> points = PointsOn(Slope, 0.8);
  for (TilePoint point : PointsOn([](double, double) { return 100.0; }, 0.8)) {
    if (is_table(double{point.column}, double{point.row})) points.push_back(point);
  }
  const ReliefTile tile = Make(points);
  for (int i = 0; i < kSide * kSide; ++i) {
    const int x = i % kSide, y = i / kSide;
    const bool inner = x > 32 && x < 67 && y > 22 && y < 77;
    const bool outer = x < 28 || x > 71 || y < 18 || y > 81;
    if (inner) {
      EXPECT_NEAR(HeightAt(tile, x, y), 100, 0.01);
    }
    if (outer) {
      EXPECT_NEAR(HeightAt(tile, x, y), Slope(x + 0.5, y + 0.5), 0.2);
    }
    if (inner) {
      EXPECT_TRUE(tile.surface.At(x, y) & kOverhang);
    }
    if (outer) {
      EXPECT_FALSE(tile.surface.At(x, y) & kOverhang);
    }
  }
}

TEST(ReliefTile, ASteepFaceIsNoOverhang) {
  const auto cliff = [](double x, double) { return x < 40 ? 0 : x > 50 ? 60 : 6 * (x - 40); };
  const ReliefTile tile = Make(PointsOn(cliff, 0.3));
  EXPECT_EQ(Share([&](int x, int y) { return (tile.surface.At(x, y) & kOverhang) != 0; }), 0);
}

// Holes of 2 and of 10 pixels, and the end of the survey at x = 80.
double Holed(double x, double y) {
  const bool is_hole =
      (x > 20 && x < 22 && y > 10 && y < 60) || (x > 40 && x < 50 && y > 30 && y < 40);
  return is_hole || x > 80 ? std::nan("") : Slope(x, y);
}

TEST(ReliefTile, GapsOfTwoCellsAreBridgedAndLargerOnesStay) {
  const ReliefTile tile = Make(PointsOn(Holed, 0.5));
  for (int i = 0; i < kSide * kSide; ++i) {
    const int x = i % kSide, y = i / kSide;
    const uint8_t flags = tile.surface.At(x, y);
    EXPECT_EQ(flags == 0, std::isnan(HeightAt(tile, x, y)));
    if (x > 20 && x < 22 && y > 12 && y < 58) {
      EXPECT_EQ(flags, kBridged);
    }
    if (flags != 0) {
      EXPECT_NEAR(HeightAt(tile, x, y), Slope(x + 0.5, y + 0.5), 0.2);
    }
    if (x >= 41 && x < 49 && y >= 31 && y < 39) {
      EXPECT_EQ(flags, 0) << x << " " << y;
    }
    if (x > 80) {
      EXPECT_EQ(flags, 0) << x << " " << y;
    }
    if (x < 18) {
      EXPECT_EQ(flags, kMeasured);
    }
  }
}

TEST(ReliefTile, FillClosesHolesMarksThemAndDoesNotGrow) {
  const ReliefTile tile = Make(PointsOn(Holed, 0.5), 1, true);
  for (int i = 0; i < kSide * kSide; ++i) {
    const int x = i % kSide, y = i / kSide;
    const bool inside = x >= 41 && x < 49 && y >= 31 && y < 39;
    if (inside) {
      EXPECT_EQ(tile.surface.At(x, y), kFilled);
    }
    if (inside) {
      EXPECT_NEAR(HeightAt(tile, x, y), Slope(x + 0.5, y + 0.5), 1);
    }
    if (x > 80) {
      EXPECT_EQ(tile.surface.At(x, y), 0);
    }
  }
}

TEST(ReliefTile, NothingAndLittleAreNothing) {
  EXPECT_TRUE(Make({}).Empty());
  const ReliefTile tile = Make({{10, 10, 5, 1}, {50, 50, 5, 1}});
  EXPECT_EQ(Share([&](int x, int y) { return tile.surface.At(x, y) != 0; }), 0);
}

TEST(LineOfSight, AWallCastsItsShadow) {
  // 10 high, at 40 <= x < 44. From a camera far to the left at 45 degrees, the 10 pixels behind it
  // are hidden; from the right nothing of them is.
  const auto wall = [](double x, double) { return x >= 40 && x < 44 ? 10.0 : 0.0; };
  const ReliefTile tile = Make(PointsOn(wall, 0.5));
  BlockRelief blocks;
  blocks.width = blocks.height = 200;
  blocks.mean.assign(200 * 200, kNoHeight);
  blocks.lowest = 0;
  blocks.highest = 10;
  blocks.FindTops();
  const LineOfSight sight(tile, kBox, blocks, 1);
  const double row = kBox.y + 40.5;
  for (int x = 2; x < kSide - 2; ++x) {
    const double height = double{HeightAt(tile, x, 40)};
    const MapPlace place(kBox.x + x + 0.5, row, height);
    const double far = 100;
    const bool from_left = sight.IsHidden(place, {place.x() - far, row, height + far});
    const bool from_right = sight.IsHidden(place, {place.x() + far, row, height + far});
    if (x > 44 && x < 52) {
      EXPECT_TRUE(from_left) << x;
    }
    if (x < 39 || x > 54) {
      EXPECT_FALSE(from_left) << x;
    }
    if (x > 31 && x < 39) {
      EXPECT_TRUE(from_right) << x;
    }
    if (x < 29 || x > 44) {
      EXPECT_FALSE(from_right) << x;
    }
    EXPECT_FALSE(sight.IsHidden(place, {place.x(), row, 100}));
  }
}

TEST(LineOfSight, BlocksBeyondTheTileHide) {
  BlockRelief blocks;
  blocks.width = blocks.height = 200;
  blocks.mean.assign(200 * 200, 0);
  blocks.lowest = 0;
  blocks.highest = 100;
  const int x = (kBox.x + kSide) / kBlockSize + 4, y = kBox.y / kBlockSize + 2;
  blocks.mean[blocks.At(x, y)] = 100;
  blocks.FindTops();
  const ReliefTile tile = Make(PointsOn([](double, double) { return 0.0; }, 0.8));
  const LineOfSight sight(tile, kBox, blocks, 1);
  const MapPlace place(kBox.x + 90.5, (y + 0.5) * kBlockSize, 0);
  EXPECT_TRUE(sight.IsHidden(place, {place.x() + 500, place.y(), 250}));
  EXPECT_FALSE(sight.IsHidden(place, {place.x() + 500, place.y(), 900}));
  EXPECT_FALSE(sight.IsHidden(place, {place.x() - 500, place.y(), 250}));
  EXPECT_TRUE(IsBlockHidden(blocks, x - 3, y, {place.x() + 500, place.y(), 250}, 1));
  EXPECT_FALSE(IsBlockHidden(blocks, x + 3, y, {place.x() + 500, place.y(), 250}, 1));
}

}  // namespace
}  // namespace colmap_seapoint
