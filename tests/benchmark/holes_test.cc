#include "examples/benchmarks/densify/holes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

// A field of 101 x 61 cells: samples 3 m - 1 to 3 m + 1 lie in cell m, from whichever end one
// counts, since the first and the last lie in the middle of theirs.
constexpr int kWidth = 301, kHeight = 181;  // samples
constexpr int kColumns = 101, kRows = 61;   // cells
constexpr int kMiddleRow = 30;
constexpr double kSpacing = 0.5, kCell = 1.5;
constexpr double kInnerCells = (kColumns - 4) * (kRows - 4);

// Cells without samples: columns [x, x + width), and rows up to `reach` from the middle one. So
// blanks are alike on either side of the middle row and leave the field's axes as they are.
struct Blank {
  int x, width, reach;
  bool Holds(int column, int row) const {
    return column >= x && column < x + width && std::abs(row - kMiddleRow) <= reach;
  }
};

// In space the field is turned and shifted. Its middle stands half a unit above its ends.
class Field {
 public:
  explicit Field(const std::vector<Blank>& blanks) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        bool is_blank = false;
        for (const Blank& blank : blanks) {
          is_blank = is_blank || blank.Holds((x + 1) / 3, (y + 1) / 3);
        }
        if (!is_blank) Add(x, y);
      }
    }
  }
  void Add(int x, int y) { cloud_.push_back({Place(x, y).cast<float>(), normal_, {}}); }
  // In samples.
  Eigen::Vector3d Place(double x, double y) const {
    const double height = x > 75 && x < 225 ? 0.5 : 0;
    return turn_ * Eigen::Vector3d(kSpacing * x, kSpacing * y, height) + Eigen::Vector3d(3, -4, 7);
  }
  Eigen::Vector3d MiddleOf(const Blank& blank) const {
    return Place(3 * blank.x + 1.5 * (blank.width - 1), 3 * kMiddleRow);
  }
  const std::vector<CloudPoint>& Cloud() const { return cloud_; }

 private:
  const Eigen::Matrix3d turn_ =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Vector3f normal_ = turn_.col(2).cast<float>();
  std::vector<CloudPoint> cloud_;
};

double InCells(double area) { return area / (kCell * kCell); }

TEST(HolesTest, AFullFieldHasNone) {
  const Field field({});
  const HoleMap map = FindHoles(field.Cloud(), kSpacing);
  EXPECT_EQ(map.cell, kCell);
  EXPECT_EQ(map.hole_share, 0);
  EXPECT_TRUE(map.holes.empty());
  EXPECT_EQ(InCells(map.area), kColumns * kRows);
  EXPECT_EQ(map.occupied_area, map.area);
  EXPECT_NEAR(MedianSpacing(field.Cloud()), kSpacing, 1e-4);
}

TEST(HolesTest, EveryEmptyCellCounts) {
  const Blank small{10, 1, 0}, middle{48, 5, 2}, wide{65, 31, 15};  // wider than the closing
  const Field field({small, middle, wide});
  const HoleMap map = FindHoles(field.Cloud(), kSpacing);
  EXPECT_EQ(InCells(map.area), kColumns * kRows);
  EXPECT_EQ(InCells(map.occupied_area), kColumns * kRows - 1 - 25 - 961);
  EXPECT_DOUBLE_EQ(map.hole_share, (1 + 25 + 961) / kInnerCells);
  ASSERT_EQ(map.holes.size(), 3u);
  const Blank by_area[] = {wide, middle, small};
  for (size_t i = 0; i < 3; ++i) {
    const Blank& blank = by_area[i];
    EXPECT_EQ(InCells(map.holes[i].area), blank.width * (2 * blank.reach + 1));
    if (blank.x != wide.x) {  // its rim stands half high, half low
      EXPECT_LT((map.holes[i].center - field.MiddleOf(blank)).norm(), 1e-2);
    }
    EXPECT_EQ(map.picture.At(map.holes[i].column, map.holes[i].row, 0), 255);
    EXPECT_EQ(map.picture.At(map.holes[i].column, map.holes[i].row, 1), 40);
  }
}

TEST(HolesTest, CellsThatTouchAtACornerAreOneHole) {
  const HoleMap map = FindHoles(Field({{20, 1, 0}, {21, 1, 1}, {60, 1, 0}}).Cloud(), kSpacing);
  ASSERT_EQ(map.holes.size(), 2u);
  EXPECT_EQ(InCells(map.holes[0].area), 4);
  EXPECT_EQ(InCells(map.holes[1].area), 1);
}

TEST(HolesTest, OneSampleFillsItsCell) {
  Field field({{48, 5, 2}});
  field.Add(3 * 50, 3 * kMiddleRow);
  const HoleMap map = FindHoles(field.Cloud(), kSpacing);
  EXPECT_DOUBLE_EQ(map.hole_share, 24 / kInnerCells);
  EXPECT_EQ(map.holes.size(), 1u);
}

TEST(HolesTest, ASlitInTheRimIsAHoleAndABayIsNone) {
  // The disc of 8 cells does not enter a slit 3 cells wide; the frayed rim does not count.
  const HoleMap slit = FindHoles(Field({{0, 20, 1}}).Cloud(), kSpacing);
  EXPECT_EQ(InCells(slit.area), kColumns * kRows);
  EXPECT_DOUBLE_EQ(slit.hole_share, 3 * 18 / kInnerCells);
  // It enters a bay 31 cells wide but for what its roundness leaves in the two corners: of 9 x 9
  // cells a quarter of it holds 9 + 9 + 9 + 8 + 8 + 7 + 6 + 5 + 1.
  const HoleMap bay = FindHoles(Field({{0, 30, 15}}).Cloud(), kSpacing);
  EXPECT_EQ(InCells(bay.area), kColumns * kRows - 930 + 2 * 19);
  EXPECT_EQ(InCells(bay.occupied_area), kColumns * kRows - 930);
  EXPECT_LT(bay.hole_share * kInnerCells, 2 * 19);
}

TEST(HolesTest, OnlyTheLargestPatchCounts) {
  Field field({{48, 5, 2}});
  for (int y = 3 * 20 - 1; y <= 3 * 40 + 1; ++y) {  // 21 x 21 cells, 30 cells aside
    for (int x = 3 * 130 - 1; x <= 3 * 150 + 1; ++x) field.Add(x, y);
  }
  const HoleMap map = FindHoles(field.Cloud(), kSpacing);
  EXPECT_EQ(InCells(map.area), kColumns * kRows);
  EXPECT_DOUBLE_EQ(map.hole_share, 25 / kInnerCells);
}

TEST(HolesTest, WhatCannotBeMeasured) {
  EXPECT_THROW(FindHoles({}, kSpacing), Error);
  EXPECT_THROW(FindHoles(Field({}).Cloud(), 1e-6), Error);
  EXPECT_THROW(MedianSpacing({}), Error);
  const Eigen::Vector3f place(1, 2, 3), none(0, 0, 0);
  EXPECT_THROW(MedianSpacing({{place, none, {}}, {place, none, {}}}), Error);
}

TEST(HolesTest, TextListsTheLargest) {
  const HoleMap map = FindHoles(Field({{10, 1, 0}, {48, 5, 2}}).Cloud(), kSpacing);
  const std::string text = HolesText(map, 1);
  EXPECT_NE(text.find("holes: 0.47 % of the inner outline, 2 of them"), std::string::npos) << text;
  EXPECT_NE(text.find("\n56.25  0.41 %  "), std::string::npos) << text;
  EXPECT_EQ(text.find("\n2.25 "), std::string::npos) << text;
}

}  // namespace
}  // namespace colmap_seapoint
