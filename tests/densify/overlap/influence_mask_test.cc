#include "densify/overlap/influence_mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace colmap_seapoint {
namespace {

constexpr SeaPointLabel kPA = SeaPointLabel::kPA, kREA = SeaPointLabel::kREA,
                        kOA = SeaPointLabel::kOA, kNA = SeaPointLabel::kNA;

SeaPoint At(double x, double y) {
  SeaPoint point;
  point.x = static_cast<float>(x);
  point.y = static_cast<float>(y);
  return point;
}

// 20 x 10 cells of 10 pixels; cell (a, b) has its centre at (10 a + 5, 10 b + 5).
const CellGrid kGrid(200, 100, 10);

// All of the previous picture is filled: the paper's whole discs.
ProcessedPicture Labelled(const std::vector<SeaPointLabel>& labels) { return {{}, labels, {}, {}}; }

bool Marked(const InfluenceMask& mask, int a, int b) {
  return mask.marked[static_cast<size_t>(20 * b + a)] != 0;
}

int NumMarked(const InfluenceMask& mask) {
  return static_cast<int>(std::count(mask.marked.begin(), mask.marked.end(), 1));
}

// Paper 2.5, Figures 10 and 11: circles around the interpair SeaPoints.
TEST(InfluenceMaskTest, MarksACircleAroundEveryMatch) {
  const InfluenceMask mask =
      MakeInfluenceMask(kGrid, {At(55, 45), At(145, 45)}, {{0, 0}}, Labelled({kPA}), 21);
  // Radius 21 around the centre of cell (5, 4): 13 cells of the disc x^2 + y^2 <= 4.41.
  EXPECT_EQ(NumMarked(mask), 13);
  EXPECT_TRUE(Marked(mask, 5, 4) && Marked(mask, 7, 4) && Marked(mask, 5, 2) && Marked(mask, 6, 5));
  EXPECT_FALSE(Marked(mask, 7, 5) || Marked(mask, 8, 4) || Marked(mask, 14, 4));
  EXPECT_DOUBLE_EQ(mask.OverlapRate(), 13.0 / 200);
}

TEST(InfluenceMaskTest, OverlappingCirclesCountOnceAndBordersCut) {
  const std::vector<SeaPoint> points = {At(5, 5), At(6, 5), At(200, 100)};
  const InfluenceMask mask =
      MakeInfluenceMask(kGrid, points, {{0, 0}, {1, 1}, {2, 2}}, Labelled({kPA, kPA, kPA}), 11);
  EXPECT_EQ(NumMarked(mask), 3 + 1);
  EXPECT_TRUE(Marked(mask, 0, 0) && Marked(mask, 1, 0) && Marked(mask, 0, 1) &&
              Marked(mask, 19, 9));
}

// Ours: an area ends where the previous picture is not filled.
TEST(InfluenceMaskTest, AreasEndWithWhatIsFilled) {
  ProcessedPicture previous = {{At(95, 45)}, {kPA}, kGrid, std::vector<float>(kGrid.Size(), 0)};
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    if (cell % 20 < 10) previous.filled[cell] = 0.9f;  // the left half
  }
  // Moved by 40 pixels: what lies right of pixel 60 was never filled.
  const InfluenceMask mask = MakeInfluenceMask(kGrid, {At(55, 45)}, {{0, 0}}, previous, 21);
  EXPECT_TRUE(Marked(mask, 5, 4) && Marked(mask, 3, 4) && Marked(mask, 5, 2));
  EXPECT_FALSE(Marked(mask, 6, 4) || Marked(mask, 7, 4));
  EXPECT_EQ(NumMarked(mask), 9);
  previous.points[0] = At(15, 45);  // moved by 40 to the right: beyond the picture's left rim
  EXPECT_EQ(NumMarked(MakeInfluenceMask(kGrid, {At(55, 45)}, {{0, 0}}, previous, 21)), 12);
}

// Paper 2.7: the matches of REA points erase, whatever the order of the matches.
TEST(InfluenceMaskTest, ReaMatchesErase) {
  const std::vector<SeaPoint> points = {At(55, 45), At(75, 45)};
  for (const FeatureMatches& matches :
       {FeatureMatches{{0, 0}, {1, 1}}, FeatureMatches{{1, 1}, {0, 0}}}) {
    const InfluenceMask mask = MakeInfluenceMask(kGrid, points, matches, Labelled({kPA, kREA}), 21);
    // Of the 13 cells around (5, 4), those within 21 of (75, 45) are erased: columns 5 to 7.
    EXPECT_TRUE(Marked(mask, 3, 4) && Marked(mask, 4, 4) && Marked(mask, 4, 5));
    EXPECT_FALSE(Marked(mask, 7, 4) || Marked(mask, 6, 4) || Marked(mask, 5, 4) ||
                 Marked(mask, 6, 5) || Marked(mask, 8, 4));
    EXPECT_TRUE(Marked(mask, 5, 5) && Marked(mask, 5, 2));
    EXPECT_EQ(NumMarked(mask), 13 - 5);
  }
}

// Masks and labels of random matches against the definition, cell by cell.
TEST(InfluenceMaskTest, AgreesWithBruteForce) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    const int width = 30 + static_cast<int>(generator() % 200);
    const int height = 30 + static_cast<int>(generator() % 150);
    const CellGrid grid(width, height, 1 + static_cast<int>(generator() % 16));
    const double radius = 2 + 40 * unit(generator);
    std::vector<SeaPoint> points;
    std::vector<SeaPointLabel> previous;
    FeatureMatches matches;
    for (uint32_t i = 0; i < 40; ++i) {
      points.push_back(At(width * unit(generator), height * unit(generator)));
      previous.push_back(unit(generator) < 0.7 ? kPA : kREA);
      if (unit(generator) < 0.3) matches.push_back({39 - i, i});
    }
    const InfluenceMask mask = MakeInfluenceMask(grid, points, matches, Labelled(previous), radius);
    const auto near = [&](size_t cell, SeaPointLabel label) {
      return std::any_of(matches.begin(), matches.end(), [&](const FeatureMatch& match) {
        const SeaPoint& point = points[match.idx2];
        return previous[match.idx1] == label &&
               (grid.Center(cell) - Eigen::Vector2d(point.x, point.y)).norm() <= radius;
      });
    };
    for (size_t cell = 0; cell < grid.Size(); ++cell) {
      ASSERT_EQ(mask.marked[cell] != 0, near(cell, kPA) && !near(cell, kREA)) << trial;
    }
    const auto labels = LabelSeaPoints(mask, points, matches, previous, radius);
    for (size_t i = 0; i < points.size(); ++i) {
      const size_t cell = grid.IndexOf(points[i].x, points[i].y);
      ASSERT_EQ(labels[i], near(cell, kREA) ? kREA : near(cell, kPA) ? kOA : kNA) << trial;
    }
  }
}

TEST(InfluenceMaskTest, NoMatchesNoOverlap) {
  EXPECT_EQ(MakeInfluenceMask(kGrid, {At(55, 45)}, {}, Labelled({kPA}), 21).OverlapRate(), 0);
  EXPECT_EQ(MakeInfluenceMask(CellGrid(), {}, {}, Labelled({}), 21).OverlapRate(), 0);
}

// OA in the mask, matched or not; REA near a match of an REA point; NA elsewhere.
TEST(LabelSeaPointsTest, ByWhereThePointsLie) {
  const std::vector<SeaPoint> points = {At(55, 45),   // matches a PA point
                                        At(62, 47),   // unmatched, inside its circle
                                        At(155, 45),  // matches an REA point
                                        At(150, 50),  // unmatched, beside it
                                        At(105, 95),  // unmatched, far from all
                                        At(199.9, 99.9)};
  const FeatureMatches matches = {{0, 0}, {1, 2}};
  const std::vector<SeaPointLabel> previous = {kPA, kREA};
  const InfluenceMask mask = MakeInfluenceMask(kGrid, points, matches, Labelled(previous), 21);
  EXPECT_EQ(LabelSeaPoints(mask, points, matches, previous, 21),
            (std::vector<SeaPointLabel>{kOA, kOA, kREA, kREA, kNA, kNA}));
}

TEST(LabelSeaPointsTest, ErasedCellsAreNoLongerOa) {
  const std::vector<SeaPoint> points = {At(55, 45), At(75, 45), At(66, 44), At(44, 45)};
  const FeatureMatches matches = {{0, 0}, {1, 1}};
  const std::vector<SeaPointLabel> previous = {kPA, kREA};
  const InfluenceMask mask = MakeInfluenceMask(kGrid, points, matches, Labelled(previous), 21);
  EXPECT_EQ(LabelSeaPoints(mask, points, matches, previous, 21),
            (std::vector<SeaPointLabel>{kREA, kREA, kREA, kOA}));
}

// Paper 2.7: REA where the neighbourhood lacks disparity.
TEST(RelabelProcessedTest, ByTheShareOfFilledCellsAround) {
  std::vector<float> filled(kGrid.Size(), 0);
  for (int b = 0; b < 10; ++b) {
    for (int a = 0; a < 10; ++a) filled[static_cast<size_t>(20 * b + a)] = 1;
  }
  EXPECT_EQ(RelabelProcessed(kGrid, filled, {At(45, 45), At(155, 45), At(95, 45), At(125, 45)}, 21),
            (std::vector<SeaPointLabel>{kPA, kREA, kPA, kREA}));
  // Around (115, 45) 1 of 13 cells is filled, around (105, 45) 4 of 13.
  EXPECT_EQ(RelabelProcessed(kGrid, filled, {At(115, 45), At(105, 45)}, 21),
            (std::vector<SeaPointLabel>{kREA, kPA}));
  std::vector<float> faint(kGrid.Size(), 0.24f);
  EXPECT_EQ(RelabelProcessed(kGrid, faint, {At(45, 45)}, 21)[0], kREA);
  faint.assign(kGrid.Size(), 0.26f);
  EXPECT_EQ(RelabelProcessed(kGrid, faint, {At(45, 45), At(0, 0)}, 21),
            (std::vector<SeaPointLabel>{kPA, kPA}));
}

TEST(RelabelProcessedTest, NothingFilledNothingProcessed) {
  const std::vector<float> empty(kGrid.Size(), 0);
  EXPECT_EQ(RelabelProcessed(kGrid, empty, {At(45, 45), At(199, 1)}, 21),
            (std::vector<SeaPointLabel>{kREA, kREA}));
}

}  // namespace
}  // namespace colmap_seapoint
