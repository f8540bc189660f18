#include "densify/sequence/partners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "densify/sequence/open_surface.h"
#include "tests/densify/sequence/survey_model.h"

namespace colmap_seapoint {
namespace {

struct Scene {
  explicit Scene(const SparseModel& given) : model(given), track(model, InOrder(model), {}) {}

  static std::vector<int> InOrder(const SparseModel& model) {
    std::vector<int> order(model.images.size());
    std::iota(order.begin(), order.end(), 0);
    return order;
  }
  std::vector<int> Partners(int position) const {
    return BestPartners(track, MeasureCovisibility(model), position);
  }
  // `covered` tells which pixels are.
  template <typename Covered>
  std::vector<int> Ranked(int position, const Covered& covered) const {
    const View view = track.ViewOf(position);
    const CellGrid grid(view.camera.width, view.camera.height, 10);
    ViewCoverage coverage{grid, std::vector<float>(grid.Size(), 0)};
    const auto ranges = PredictRanges(model, track.Image(position), view, coverage);
    for (size_t cell = 0; cell < grid.Size(); ++cell) {
      if (covered(grid.Center(cell))) coverage.range[cell] = static_cast<float>(ranges[cell]);
    }
    return RankForOpenSurface(track, view, coverage, ranges, Partners(position));
  }
  std::vector<int> Ranked(int position) const {
    return Ranked(position, [](const Eigen::Vector2d&) { return false; });
  }

  SparseModel model;
  Track track;
};

// Overlap between successive pictures of one strip; `count` of them.
Scene Strip(double overlap, int count) {
  SurveyModel survey;
  for (int k = 0; k < count; ++k) {
    survey.AddAbove(std::to_string(k), (1 - overlap) * SurveyModel::kWidth * k);
  }
  return Scene(survey.WithGround());
}

double Baseline(const Scene& scene, int a, int b) {
  return (scene.track.Image(a).cam_from_world.OriginInSource() -
          scene.track.Image(b).cam_from_world.OriginInSource())
      .norm();
}

TEST(BestPartnersTest, OfAStripTheNearestFirst) {
  const Scene scene = Strip(0.8, 9);
  const std::vector<int> partners = scene.Partners(4);
  ASSERT_GE(partners.size(), 6u);
  std::vector<int> nearest(partners.begin(), partners.begin() + 2);
  std::sort(nearest.begin(), nearest.end());
  EXPECT_EQ(nearest, (std::vector<int>{3, 5}));
  EXPECT_EQ(std::count(partners.begin(), partners.end(), 4), 0);
}

// 30 pictures a second, two of them 0.3 degrees apart: those that hardly move share most and are
// worth nothing.
TEST(BestPartnersTest, OfAVideoThoseThatMeasureDepth) {
  SurveyModel survey;
  for (int k = 0; k < 200; ++k) survey.AddAbove(std::to_string(k), 0.01 * k);
  const Scene scene(survey.WithGround(0.2));
  const std::vector<int> partners = scene.Partners(100);
  ASSERT_GE(partners.size(), 6u);
  ASSERT_LE(partners.size(), 32u);
  EXPECT_GE(Baseline(scene, 100, partners[0]), 0.15);
  EXPECT_LE(Baseline(scene, 100, partners[0]), 0.5);
  int num_behind = 0;
  for (size_t i = 0; i < partners.size(); ++i) {
    EXPECT_GE(Baseline(scene, 100, partners[i]), 0.06) << partners[i];
    num_behind += partners[i] < 100;
    // None stands for what another one shows already.
    for (size_t k = 0; k < i; ++k) {
      EXPECT_GE(Baseline(scene, partners[i], partners[k]),
                0.2 * Baseline(scene, 100, partners[k]) - 1e-9);
    }
  }
  EXPECT_GE(num_behind, 3);
  EXPECT_LE(num_behind, static_cast<int>(partners.size()) - 3);
}

TEST(BestPartnersTest, ACarrierThatHoversHasThoseWhereItMoved) {
  SurveyModel survey;
  for (int k = 0; k < 60; ++k) survey.AddAbove(std::to_string(k), 1e-4 * (k % 3));
  survey.AddAbove("60", 0.3);
  survey.AddAbove("61", 0.6);
  const Scene scene(survey.WithGround(0.2));
  std::vector<int> partners = scene.Partners(7);
  std::sort(partners.begin(), partners.end());
  EXPECT_EQ(partners, (std::vector<int>{60, 61}));
  SurveyModel still;
  for (int k = 0; k < 10; ++k) still.AddAbove(std::to_string(k), 1e-4 * (k % 3));
  EXPECT_TRUE(Scene(still.WithGround(0.2)).Partners(0).empty());
}

// Beside one another, but one looks ahead and one down.
TEST(BestPartnersTest, DirectionsDiffer) {
  SurveyModel survey;
  survey.AddAbove("0", 0);
  survey.AddAbove("1", 0.5);
  survey.AddAbove("2", 0.51);
  survey.Add("3", StandAt(SurveyModel::TestCamera(), {0.52, 0, 0}, {0, 20, 0}));
  const std::vector<int> partners = Scene(survey.WithGround()).Partners(0);
  EXPECT_EQ(partners.size(), 2u);
  EXPECT_EQ(std::count(partners.begin(), partners.end(), 3), 1);
}

// Around an object, 5 degrees apart: 20 degrees are better than 5 and than 90.
TEST(BestPartnersTest, ACircle) {
  SurveyModel survey;
  for (int k = 0; k < 72; ++k) {
    const double angle = 5.0 * k;
    const double radians = angle * M_PI / 180;
    Viewpoint viewpoint = StandAt(SurveyModel::TestCamera(), {0, 0, 0});
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(radians, Eigen::Vector3d::UnitY()));
    viewpoint.cam_from_world = {turn, {0, 0, 3}};  // looks at the origin from 3 away
    survey.Add(std::to_string(k), viewpoint);
  }
  std::vector<Eigen::Vector3d> points;
  for (double x = -0.5; x <= 0.5; x += 0.1) {
    for (double y = -0.5; y <= 0.5; y += 0.1) {
      for (double z = -0.5; z <= 0.5; z += 0.1) points.push_back({x, y, z});
    }
  }
  const Scene scene(survey.WithPoints(points));
  const std::vector<int> partners = scene.Partners(0);
  ASSERT_GE(partners.size(), 4u);
  const auto apart = [](int partner) { return 5 * std::min(partner, 72 - partner); };
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_GE(apart(partners[k]), 5) << k;
    EXPECT_LE(apart(partners[k]), 30) << k;
  }
  for (const int partner : partners) EXPECT_LT(apart(partner), 80);
}

// The widest pair that still sees most of what `first` does, as long as that is worth it.
TEST(RankForOpenSurfaceTest, AStripsFirstPair) {
  EXPECT_EQ(Strip(0.8, 6).Ranked(0).front(), 2);
  EXPECT_EQ(Strip(0.7, 6).Ranked(0).front(), 1);
  EXPECT_EQ(Strip(0.6, 6).Ranked(0).front(), 1);
  EXPECT_GE(Strip(0.95, 30).Ranked(0).front(), 4);
}

// What the pictures before have covered does not count.
TEST(RankForOpenSurfaceTest, OnlyWhatIsOpenCounts) {
  const Scene scene = Strip(0.7, 9);
  EXPECT_GT(scene.Ranked(4, [](const auto& pixel) { return pixel.x() < 150; }).front(), 4);
  EXPECT_LT(scene.Ranked(4, [](const auto& pixel) { return pixel.x() > 250; }).front(), 4);
  EXPECT_TRUE(scene.Ranked(4, [](const auto&) { return true; }).empty());
}

TEST(RankForOpenSurfaceTest, OfAVideoAWidePair) {
  SurveyModel survey;
  for (int k = 0; k < 120; ++k) survey.AddAbove(std::to_string(k), 0.01 * k);
  const Scene scene(survey.WithGround(0.2));
  const double baseline = Baseline(scene, 0, scene.Ranked(0).front());
  EXPECT_GE(baseline, 0.3);
  EXPECT_LE(baseline, 1.0);
}

TEST(MarkSeenByBothTest, WhatBothSeeCountsAsCovered) {
  const Scene scene = Strip(0.75, 4);
  const View view = scene.track.ViewOf(2);
  const CellGrid grid(400, 300, 10);
  ViewCoverage coverage{grid, std::vector<float>(grid.Size(), 0)};
  const auto ranges = PredictRanges(scene.model, scene.track.Image(2), view, coverage);
  coverage.range[0] = 7;
  MarkSeenByBoth(view, ranges, scene.track.ViewOf(0), scene.track.ViewOf(1), &coverage);
  EXPECT_EQ(coverage.range[0], 7);
  // Picture 0 sees the left half of picture 2, picture 1 that and a quarter more.
  for (size_t cell = 1; cell < grid.Size(); ++cell) {
    const Eigen::Vector2d center = grid.Center(cell);
    if (center.y() < 4 || center.y() > 296 || std::abs(center.x() - 200) < 15) continue;
    EXPECT_EQ(coverage.range[cell] > 0, center.x() < 200) << center.transpose();
  }
}

}  // namespace
}  // namespace colmap_seapoint
