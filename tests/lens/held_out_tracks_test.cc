#include "colmap_seapoint/lens/held_out_tracks.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/lens/noisy_survey.h"
#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

size_t NumObservations(const SparseModel& model) {
  size_t count = 0;
  for (const PosedImage& image : model.images) count += image.points2D.size();
  return count;
}

double Sum(const std::vector<double>& costs) {
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

const RobustLoss kLoss = {LossKind::kGemanMcClure, 1};

TEST(SplitTest, NoTrackIsInBothAndEachIsWhole) {
  const SparseModel model = ExactSurvey(ExactLens(), 5);
  TrackSplit split;
  split.held_out_every = 5;
  const SplitTracks tracks = Split(split, model);
  size_t num_long = 0;
  for (const auto& [id, point] : model.points3D) num_long += point.track.size() >= 3 ? 1 : 0;
  EXPECT_EQ(tracks.held_out.points3D.size(), num_long / 5);
  EXPECT_EQ(tracks.fitted.points3D.size(), num_long - num_long / 5);
  for (const auto& [id, point] : tracks.held_out.points3D) {
    EXPECT_EQ(tracks.fitted.points3D.count(id), 0u);
    const SparsePoint& whole = model.points3D.at(id);
    ASSERT_EQ(point.track.size(), whole.track.size());
    EXPECT_EQ(point.xyz, whole.xyz);
    for (const auto& element : point.track) {
      EXPECT_EQ(tracks.held_out.images[element.image_id - 1].point3D_ids[element.point2D_idx], id);
    }
  }
}

TEST(SplitTest, HoldsNoMoreThanAsked) {
  const SparseModel model = ExactSurvey(ExactLens(), 5);
  TrackSplit split;
  split.held_out_every = 2;
  split.max_fitted_observations = 400;
  split.max_held_out_observations = 300;
  const SplitTracks tracks = Split(split, model);
  EXPECT_LE(NumObservations(tracks.fitted), 440u);
  EXPECT_GE(NumObservations(tracks.fitted), 200u);
  EXPECT_LE(NumObservations(tracks.held_out), 330u);
  EXPECT_TRUE(Split(split, SparseModel()).fitted.points3D.empty());
}

TEST(HeldOutCostsTest, ExactCamerasCostNothingAndOthersDo) {
  const SparseModel model = ExactSurvey(ExactLens(), 5);
  SparseModel held_out = model;
  for (auto& [id, point] : held_out.points3D) point.xyz += Eigen::Vector3d(0.02, -0.01, 0.05);
  EXPECT_LT(Sum(HeldOutCosts(held_out, model, kLoss, 1)), 1e-8);
  SparseModel wrong = model;
  wrong.cameras.at(1).params[4] *= 1.1;
  EXPECT_GT(Sum(HeldOutCosts(held_out, wrong, kLoss, 1)), 1);
}

// Half of the squared noise for every value that a point does not take up.
TEST(HeldOutCostsTest, NoiseCostsWhatTheDegreesOfFreedomSay) {
  constexpr double kSigma = 0.1;
  const SparseModel model = ExactSurvey(ExactLens(), 5);
  const SparseModel noisy = NoisySurvey(ExactLens(), 5, kSigma);
  const RobustLoss squares = {LossKind::kSquares, 1};
  const std::vector<double> costs = HeldOutCosts(noisy, model, squares, 1);
  double expected = 0;
  size_t num_points = 0;
  for (const auto& [id, point] : noisy.points3D) {
    if (point.track.size() < 2) continue;
    ++num_points;
    expected += 0.5 * kSigma * kSigma * (2.0 * static_cast<double>(point.track.size()) - 3);
  }
  ASSERT_EQ(costs.size(), num_points);
  EXPECT_NEAR(Sum(costs), expected, 0.05 * expected);
}

TEST(HeldOutCostsTest, TheSameForAnyNumberOfThreads) {
  const SparseModel noisy = NoisySurvey(ExactLens(), 5, 0.3);
  EXPECT_EQ(HeldOutCosts(noisy, noisy, kLoss, 1), HeldOutCosts(noisy, noisy, kLoss, 3));
}

}  // namespace
}  // namespace colmap_seapoint
