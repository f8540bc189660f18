#include "densify/overlap/pair_overlap.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace colmap_seapoint {
namespace {

using Label = SeaPointLabel;

SeaPoint PointAt(float x, float y) {
  SeaPoint point;
  point.x = x;
  point.y = y;
  return point;
}

const CellGrid kGrid(40, 10, 10);  // four cells in a row
const std::vector<SeaPoint> kPoints = {PointAt(5, 5), PointAt(15, 5), PointAt(25, 5),
                                       PointAt(35, 5)};
constexpr double kRadius = 2;  // an influence area marks its own cell only where it is centred

ProcessedPicture Previous(std::vector<Label> labels) {
  ProcessedPicture previous;
  previous.points = kPoints;
  previous.labels = std::move(labels);
  return previous;
}

PairOverlap Against(const ProcessedPicture& previous, const FeatureMatches& matches) {
  InfluenceMask mask = MakeInfluenceMask(kGrid, kPoints, matches, previous, kRadius);
  return OverlapWithPrevious(std::move(mask), kPoints, matches, previous, kRadius);
}

TEST(PairOverlapTest, WithoutPreviousAllIsNew) {
  const PairOverlap overlap = WithoutPrevious(kGrid, kPoints);
  EXPECT_EQ(overlap.labels, std::vector<Label>(4, Label::kNA));
  EXPECT_EQ(overlap.rate, 0);
  EXPECT_EQ(overlap.mask.grid.Size(), 0u);
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) EXPECT_TRUE(overlap.known.IsNew(cell));
}

TEST(PairOverlapTest, WithPreviousTheMaskIsClosed) {
  const PairOverlap overlap =
      Against(Previous({Label::kPA, Label::kREA, Label::kPA, Label::kPA}), {{0, 0}, {1, 1}});
  EXPECT_EQ(overlap.labels, (std::vector<Label>{Label::kOA, Label::kREA, Label::kNA, Label::kNA}));
  EXPECT_EQ(overlap.rate, 0.25);
  EXPECT_EQ(overlap.known.closed, overlap.mask.marked);
  EXPECT_TRUE(overlap.known.IsClosed(0));
  EXPECT_FALSE(overlap.known.IsCovered(0));
  EXPECT_TRUE(overlap.known.IsNew(1));
}

// Matches took the first two cells for known; the poses know the second and the third.
TEST(PairOverlapTest, WithAllThePosesDecide) {
  PairOverlap sequential = Against(Previous(std::vector<Label>(4, Label::kPA)), {{0, 0}, {1, 1}});
  const ViewCoverage coverage = {kGrid, {0, 2, 3, 0}};
  const PairOverlap overlap = OverlapWithAll(sequential, coverage, kPoints);
  EXPECT_EQ(overlap.labels, (std::vector<Label>{Label::kREA, Label::kOA, Label::kOA, Label::kNA}));
  EXPECT_EQ(overlap.rate, 0.5);
  EXPECT_TRUE(overlap.known.closed.empty());
  EXPECT_EQ(overlap.known.covered_range, coverage.range);
  EXPECT_EQ(overlap.mask.marked, sequential.mask.marked);
}

TEST(KnownCellsTest, EitherVectorMayBeEmpty) {
  KnownCells known;
  known.grid = kGrid;
  EXPECT_TRUE(known.IsNew(0));
  known.closed = {1, 0, 0, 0};
  EXPECT_FALSE(known.IsNew(0));
  EXPECT_TRUE(known.IsNew(1));
  known.covered_range = {0, 4, 0, 0};
  EXPECT_TRUE(known.IsCovered(1));
  EXPECT_FALSE(known.IsNew(1));
  EXPECT_TRUE(known.IsNew(2));
}

}  // namespace
}  // namespace colmap_seapoint
