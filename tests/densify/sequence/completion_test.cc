#include "densify/sequence/completion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;

View ViewAbove(double x, double y = 0) {
  const Viewpoint viewpoint =
      StandAt(MakeCamera(CameraModel::kPinhole, 400, 400, 300), {x, y, 0}, {0, 0, 0});
  return {0, viewpoint.camera, viewpoint.cam_from_world};
}

// The left half of the picture is covered.
ViewCoverage LeftHalfCovered(const View& view, const CellGrid& grid) {
  ViewCoverage coverage{grid, std::vector<float>(grid.Size(), 0)};
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (grid.Center(cell).x() >= 200) continue;
    coverage.range[cell] = static_cast<float>(
        kDepth * view.camera.CamFromImg(grid.Center(cell))->homogeneous().norm());
  }
  return coverage;
}

const CellGrid kGrid(400, 300, 10);

std::vector<double> TrueRanges(const View& view) {
  std::vector<double> range;
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    range.push_back(kDepth * view.camera.CamFromImg(kGrid.Center(cell))->homogeneous().norm());
  }
  return range;
}

CompletionView SeenAs(const ViewCoverage& coverage, const std::vector<double>& range) {
  return {coverage, range, std::vector<uint8_t>(coverage.grid.Size(), 0)};
}

int Partner(const View& view, const ViewCoverage& coverage, const std::vector<double>& range,
            const std::vector<CompletionCandidate>& candidates) {
  return SelectCompletionPartner(view, SeenAs(coverage, range), candidates).partner;
}

TEST(SelectCompletionPartnerTest, PicksTheOneThatSeesTheHole) {
  const View view = ViewAbove(0);
  const ViewCoverage coverage = LeftHalfCovered(view, kGrid);
  const std::vector<double> range = TrueRanges(view);
  const CompletionCandidate left = {3, ViewAbove(-0.8)}, right = {7, ViewAbove(0.4)},
                            far_right = {8, ViewAbove(1.1)}, beyond = {9, ViewAbove(5)};
  EXPECT_EQ(Partner(view, coverage, range, {left, right, far_right, beyond}), 7);
  EXPECT_EQ(Partner(view, coverage, range, {beyond, far_right, right, left}), 7);
  EXPECT_EQ(Partner(view, coverage, range, {left, far_right}), 8);
  EXPECT_EQ(Partner(view, coverage, range, {beyond}), -1);
  EXPECT_EQ(Partner(view, coverage, range, {}), -1);
}

TEST(SelectCompletionPartnerTest, BaselineMustMeasureDepth) {
  const View view = ViewAbove(0);
  const ViewCoverage coverage = LeftHalfCovered(view, kGrid);
  const std::vector<double> range = TrueRanges(view);
  EXPECT_EQ(Partner(view, coverage, range, {{1, ViewAbove(0.02)}}), -1);
  EXPECT_EQ(Partner(view, coverage, range, {{1, ViewAbove(0)}}), -1);
  EXPECT_EQ(Partner(view, coverage, range, {{1, ViewAbove(0.2)}}), 1);
}

// Both see all of it: at 29 degrees between the rays, and at 1.5 times the distance.
TEST(SelectCompletionPartnerTest, QualityCountsBesidesArea) {
  const View view = ViewAbove(0);
  const ViewCoverage nothing{kGrid, std::vector<float>(kGrid.Size(), 0)};
  const auto from = [](double x, double z) {
    const Viewpoint viewpoint =
        StandAt(MakeCamera(CameraModel::kPinhole, 200, 400, 300), {x, 0, z});
    return View{0, viewpoint.camera, viewpoint.cam_from_world};
  };
  const CompletionCandidate good = {1, from(0.6, 0)}, far = {2, from(0.6, -2)},
                            wide = {3, from(2.0, 0)};
  const std::vector<double> range = TrueRanges(view);
  EXPECT_EQ(Partner(view, nothing, range, {good, far, wide}), 1);
  EXPECT_EQ(Partner(view, nothing, range, {wide, far, good}), 1);
  EXPECT_EQ(Partner(view, nothing, range, {far}), 2);
  EXPECT_EQ(Partner(view, nothing, range, {wide}), 3) << "45 degrees are better than none";
}

// A camera that moves along its optical axis has a baseline like any other.
TEST(SelectCompletionPartnerTest, AlongTheOpticalAxis) {
  const View view = ViewAbove(0);
  const Viewpoint ahead = StandAt(view.camera, {0, 0, 0.5});
  const ViewCoverage nothing{kGrid, std::vector<float>(kGrid.Size(), 0)};
  CompletionView seen = SeenAs(nothing, TrueRanges(view));
  const CompletionTarget target =
      SelectCompletionPartner(view, seen, {{5, {0, ahead.camera, ahead.cam_from_world}}});
  ASSERT_EQ(target.partner, 5);
  // Around the epipole there is no parallax.
  EXPECT_EQ(target.closed[kGrid.IndexOf(200, 150)], 1);
  EXPECT_EQ(target.closed[kGrid.IndexOf(90, 150)], 0);
}

TEST(SelectCompletionPartnerTest, NothingUncoveredNoPartner) {
  const View view = ViewAbove(0);
  const std::vector<double> range = TrueRanges(view);
  ViewCoverage full{kGrid, std::vector<float>(kGrid.Size(), 2.f)};
  EXPECT_EQ(Partner(view, full, range, {{1, ViewAbove(0.2)}}), -1);
  // A few open cells are not worth a pair: 1 % of 1200 are 12.
  for (size_t cell = 600; cell < 612; ++cell) full.range[cell] = 0;
  EXPECT_EQ(Partner(view, full, range, {{1, ViewAbove(0.2)}}), -1);
  for (size_t cell = 600; cell < 620; ++cell) full.range[cell] = 0;
  EXPECT_EQ(Partner(view, full, range, {{1, ViewAbove(0.2)}}), 1);
}

// The pair is for the uncovered cells that its partner sees, and for nothing else.
TEST(SelectCompletionPartnerTest, ClosesAllButItsTarget) {
  const View view = ViewAbove(0), partner = ViewAbove(0.3);
  CompletionView seen = SeenAs(LeftHalfCovered(view, kGrid), TrueRanges(view));
  seen.tries[25] = kMaxTries;
  const CompletionTarget target = SelectCompletionPartner(view, seen, {{4, partner}});
  ASSERT_EQ(target.partner, 4);
  int num_open = 0;
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    if (target.closed[cell]) continue;
    ++num_open;
    EXPECT_EQ(seen.coverage.range[cell], 0);
    EXPECT_NE(cell, 25u);
  }
  EXPECT_GT(num_open, 300);
}

// What failed is worth no pair of its own, and what failed kMaxTries times is not tried along with
// others.
TEST(GivenUpTest, AfterSomeFailures) {
  const View view = ViewAbove(0);
  const std::vector<PackedFootprint> nothing;
  GivenUp given_up;
  const CompletionCandidate candidate = {4, ViewAbove(0.3)};
  const auto look_at = [&](const View& at) {
    CompletionView seen = LookAt(at, kGrid, nothing, given_up);
    seen.predicted_range = TrueRanges(at);
    return seen;
  };
  CompletionView seen = look_at(view);
  const CompletionTarget target = SelectCompletionPartner(view, seen, {candidate});
  ASSERT_EQ(target.partner, 4);
  for (size_t tries = 1; tries <= kMaxTries; ++tries) {
    NoteFailures(view, target, {}, &seen, &given_up);
    seen = look_at(view);
    EXPECT_EQ(SelectCompletionPartner(view, seen, {candidate}).partner, -1);
    // From elsewhere it is the same surface.
    size_t num_tried = 0;
    for (const uint8_t count : look_at(ViewAbove(0.1)).tries) num_tried += count == tries;
    EXPECT_GT(num_tried, kGrid.Size() / 2) << tries;
  }
}

// Windows do not fit at a picture's own edge; a neighbour may well see that surface in its middle.
TEST(CompletionTest, SurfaceAtThePicturesEdgeIsNotGivenUp) {
  const View view = ViewAbove(0);
  const CellGrid fine(400, 300, 4);
  CompletionView seen;
  seen.coverage = {fine, std::vector<float>(fine.Size(), 0)};
  seen.predicted_range.assign(fine.Size(), kDepth);
  seen.tries.assign(fine.Size(), 0);
  GivenUp given_up;
  NoteFailures(view, {4, std::vector<uint8_t>(fine.Size(), 0)}, {}, &seen, &given_up);
  for (size_t cell = 0; cell < fine.Size(); ++cell) {
    const Eigen::Vector2d center = fine.Center(cell);
    const bool inner = center.x() >= 4 && center.x() <= 396 && center.y() >= 3 && center.y() <= 297;
    ASSERT_EQ(seen.tries[cell], inner ? 1 : 0) << center.transpose();
  }
}

TEST(SeedsAlongRimTest, OnePerOpenCellBesideACoveredOne) {
  const View view = ViewAbove(0), partner = ViewAbove(0.3);
  const ViewCoverage coverage = LeftHalfCovered(view, kGrid);
  const std::vector<PixelPair> seeds =
      SeedsAlongRim(view, partner, SeenAs(coverage, TrueRanges(view)));
  ASSERT_EQ(seeds.size(), 30u);  // column 20, all rows
  for (const PixelPair& seed : seeds) {
    EXPECT_EQ(seed.pixel1.x(), 205);
    EXPECT_NEAR(seed.pixel2.x(), 205 - 400 * 0.3 / kDepth, 1e-9);
    EXPECT_NEAR(seed.pixel2.y(), seed.pixel1.y(), 1e-9);
  }
  EXPECT_TRUE(SeedsAlongRim(view, ViewAbove(5), SeenAs(coverage, TrueRanges(view))).empty());
}

}  // namespace
}  // namespace colmap_seapoint
