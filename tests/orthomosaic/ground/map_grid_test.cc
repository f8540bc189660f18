#include "colmap_seapoint/orthomosaic/ground/map_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

std::vector<Eigen::Vector3d> Square(double left, double low, double side, int n) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < n * n; ++i) {
    points.emplace_back(left + side * (i % n) / (n - 1), low + side * (i / n) / (n - 1), 1);
  }
  return points;
}

TEST(MapGrid, HoldsAllPointsOfAPlainSquare) {
  const auto points = Square(-3.3, 7.1, 10, 40);
  const MapGrid grid = MakeMapGrid(points, 0.01);
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector2d pixel = grid.PixelOf(point.x(), point.y());
    EXPECT_GE(pixel.minCoeff(), 0);
    EXPECT_LT(pixel.x(), grid.width);
    EXPECT_LT(pixel.y(), grid.height);
  }
  EXPECT_LT(grid.width, 1.05 * 1000);
  EXPECT_LT(grid.height, 1.05 * 1000);
}

TEST(MapGrid, RowsGoDownAndColumnsRight) {
  const MapGrid grid = MakeMapGrid(Square(0, 0, 1, 10), 0.1);
  const Eigen::Vector2d corner = grid.PlaceOf(0, 0), inside = grid.PlaceOf(1, 1);
  EXPECT_LT(corner.x(), inside.x());
  EXPECT_GT(corner.y(), inside.y());
  EXPECT_NEAR((grid.PixelOf(inside.x(), inside.y()) - Eigen::Vector2d(1, 1)).norm(), 0, 1e-12);
}

TEST(MapGrid, EdgesAreWholePixelsOfTheFrame) {
  const MapGrid grid = MakeMapGrid(Square(0.123, -4.567, 3, 10), 0.25);
  EXPECT_DOUBLE_EQ(grid.left / 0.25, std::round(grid.left / 0.25));
  EXPECT_DOUBLE_EQ(grid.top / 0.25, std::round(grid.top / 0.25));
}

TEST(MapGrid, AFewFarPointsDoNotMakeItLarge) {
  auto points = Square(0, 0, 10, 100);
  for (int i = 0; i < 5; ++i) points.emplace_back(1e6, -1e6, 0);
  EXPECT_LT(MakeMapGrid(points, 0.1).width, 110);
}

TEST(MapGrid, OnePointIsAMapOfOnePixel) {
  const MapGrid grid = MakeMapGrid({{5, 5, 5}}, 0.1);
  EXPECT_EQ(grid.width, 1);
  EXPECT_EQ(grid.height, 1);
}

TEST(MapGrid, TooManyPixelsAreRefusedWithAPixelSizeThatIsNot) {
  const auto points = Square(0, 0, 1000, 10);
  std::string text;
  try {
    MakeMapGrid(points, 0.001);
  } catch (const Error& error) {
    text = error.what();
  }
  ASSERT_NE(text.find("give a pixel size of 0.0105"), std::string::npos) << text;
  EXPECT_NO_THROW(MakeMapGrid(points, 0.0105));
}

TEST(MapGrid, TilesCoverTheMapOnceAlongACurveWithoutJumps) {
  MapGrid grid;
  grid.tile_size = 64;
  grid.width = 64 * 8;
  grid.height = 64 * 8;
  const std::vector<int> tiles = TilesAlongCurve(grid);
  EXPECT_EQ(std::set<int>(tiles.begin(), tiles.end()).size(), 64u);
  ASSERT_EQ(tiles.size(), 64u);
  for (size_t i = 1; i < tiles.size(); ++i) {
    const int dx = std::abs(tiles[i] % 8 - tiles[i - 1] % 8);
    const int dy = std::abs(tiles[i] / 8 - tiles[i - 1] / 8);
    EXPECT_EQ(dx + dy, 1) << i;
  }
  grid.width = 64 * 5 - 10;
  grid.height = 64 * 3 - 63;
  EXPECT_EQ(TilesAlongCurve(grid).size(), 15u);
  EXPECT_EQ(grid.Tile(14).width, 54);
  EXPECT_EQ(grid.Tile(14).height, 1);
}

}  // namespace
}  // namespace colmap_seapoint
