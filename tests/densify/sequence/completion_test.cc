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

SparseModel ModelOfOneImage() {
  SparseModel model;
  model.images.emplace_back();
  return model;
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

TEST(PredictRangesTest, FromCoverageAndTheModelsPoints) {
  SparseModel model = ModelOfOneImage();
  const View view = ViewAbove(0);
  model.images[0].point3D_ids = {kNoPoint3D, 5, 6};
  model.points3D[5].xyz = {0.9, 0.0, 3.0};   // pixel (320, 150)
  model.points3D[6].xyz = {-0.5, 0.0, 7.0};  // in the covered half: no news
  ViewCoverage coverage = LeftHalfCovered(view, kGrid);
  const auto range = PredictRanges(model, model.images[0], view, coverage);
  ASSERT_EQ(range.size(), kGrid.Size());
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    EXPECT_GT(range[cell], 0);
    if (coverage.range[cell] > 0) {
      EXPECT_EQ(range[cell], coverage.range[cell]);
    }
  }
  const double at_point = Eigen::Vector3d(0.9, 0, 3).norm();
  EXPECT_NEAR(range[kGrid.IndexOf(320, 150)], at_point, 1e-9);
  EXPECT_NEAR(range[kGrid.IndexOf(345, 145)], at_point, 1e-9);
  EXPECT_EQ(range[kGrid.IndexOf(205, 25)], coverage.range[kGrid.IndexOf(195, 25)]);

  coverage.range.assign(kGrid.Size(), 0);
  model.images[0].point3D_ids.clear();
  for (const double nothing : PredictRanges(model, model.images[0], view, coverage)) {
    EXPECT_EQ(nothing, 0);
  }
}

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
  seen.tries[25] = 2;
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

// What failed is worth no pair of its own, and what failed twice is not tried along with others.
TEST(GivenUpTest, AfterTwoFailures) {
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
  NoteFailures(view, target, {}, &seen, &given_up);
  seen = look_at(view);
  EXPECT_EQ(SelectCompletionPartner(view, seen, {candidate}).partner, -1);
  NoteFailures(view, target, {}, &seen, &given_up);
  // From elsewhere it is the same surface.
  const CompletionView aside = look_at(ViewAbove(0.1));
  int num_given_up = 0;
  for (const uint8_t count : aside.tries) num_given_up += count == 2;
  EXPECT_GT(num_given_up, static_cast<int>(kGrid.Size() / 2));
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
