#include "densify/sequence/covisibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/densify/sequence/survey_model.h"

namespace colmap_seapoint {
namespace {

// A point 1 before camera 1, seen from the side at an angle, from `ratio` times the distance.
double QualityAt(double parallax_deg, double ratio = 1) {
  const double angle = parallax_deg * M_PI / 180;
  const Eigen::Vector3d point(3, 4, 5);
  return ViewQuality(point, point - Eigen::Vector3d(0, 0, 1),
                     point - ratio * Eigen::Vector3d(std::sin(angle), 0, std::cos(angle)));
}

TEST(ViewQualityTest, OfTheParallax) {
  EXPECT_EQ(QualityAt(0), 0);
  EXPECT_EQ(QualityAt(1.4), 0);
  EXPECT_NEAR(QualityAt(3.75), 0.5, 1e-9);
  for (const double parallax : {6.01, 15.0, 24.99}) EXPECT_EQ(QualityAt(parallax), 1);
  EXPECT_NEAR(QualityAt(42.5), 0.5, 1e-9);
  EXPECT_EQ(QualityAt(61), 0);
}

TEST(ViewQualityTest, OfTheScale) {
  EXPECT_EQ(QualityAt(15, 1.29), 1);
  EXPECT_NEAR(QualityAt(15, 2.4), 0.5, 1e-9);
  EXPECT_NEAR(QualityAt(15, 1 / 2.4), 0.5, 1e-9);
  EXPECT_EQ(QualityAt(15, 3.6), 0);
  EXPECT_NEAR(QualityAt(42.5, 2.4), 0.25, 1e-9);
}

SparseModel ModelWithTracks(size_t num_images, const std::vector<std::vector<uint32_t>>& tracks) {
  SurveyModel survey;
  for (size_t i = 0; i < num_images; ++i) {
    survey.AddAbove("", 0.2 * static_cast<double>(i));  // 6 degrees and more apart
  }
  SparseModel model = survey.WithPoints({});
  for (const auto& track : tracks) {
    SparsePoint point;
    point.xyz = {0.4, 0, 1.5};
    for (const uint32_t image : track) point.track.push_back({7 + image, 0});
    model.points3D[model.points3D.size() + 1] = point;
  }
  return model;
}

TEST(CovisibilityTest, CountsAndQualityOfShortTracks) {
  // The third track lists a picture twice, the last one a picture that the model lacks.
  const SparseModel model =
      ModelWithTracks(5, {{0, 1, 2}, {1, 0}, {1, 3, 1}, {3, 0, 1}, {0, 3}, {0, 77}});
  const Covisibility covisibility = MeasureCovisibility(model);
  ASSERT_EQ(covisibility.size(), 5u);
  ASSERT_EQ(covisibility[0].size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(covisibility[0][k].image_idx, static_cast<int>(k) + 1);
  }
  EXPECT_EQ(covisibility[0][0].count, 3);
  EXPECT_EQ(covisibility[0][1].count, 1);
  EXPECT_EQ(covisibility[0][2].count, 2);
  const auto center = [&](size_t i) { return model.images[i].cam_from_world.OriginInSource(); };
  EXPECT_NEAR(covisibility[0][0].quality,
              3 * ViewQuality(model.points3D.at(1).xyz, center(0), center(1)), 1e-9);
  EXPECT_GT(covisibility[0][0].quality, 2);
  ASSERT_EQ(covisibility[3].size(), 2u);
  EXPECT_EQ(covisibility[3][0].count, 2);
  EXPECT_EQ(covisibility[3][1].count, 2);
  EXPECT_TRUE(covisibility[4].empty());
}

// A carrier that hovers: every point in all of 200 pictures. Work is bounded, and no pair of
// pictures is missed for good.
TEST(CovisibilityTest, LongTracksAreDrawnWithoutBias) {
  std::vector<uint32_t> all(200);
  for (uint32_t i = 0; i < 200; ++i) all[i] = i;
  const SparseModel model = ModelWithTracks(200, std::vector<std::vector<uint32_t>>(2000, all));
  const Covisibility covisibility = MeasureCovisibility(model);
  double sum = 0, sum_near = 0;
  int num_near = 0, num = 0;
  for (size_t i = 0; i < 200; ++i) {
    ASSERT_EQ(covisibility[i].size(), 199u);
    for (const SharedPoints& shared : covisibility[i]) {
      EXPECT_GT(shared.count, 400);
      EXPECT_LT(shared.count, 5000);
      sum += shared.count;
      ++num;
      if (std::abs(shared.image_idx - static_cast<int>(i)) > 1) continue;
      sum_near += shared.count;
      ++num_near;
    }
  }
  EXPECT_NEAR(sum / num, 2000, 1);
  EXPECT_NEAR(sum_near / num_near, 2000, 60);
}

TEST(CovisibilityTest, TheOrderOfTracksDoesNotMatter) {
  std::vector<uint32_t> forward(60);
  for (uint32_t i = 0; i < 60; ++i) forward[i] = i;
  std::vector<uint32_t> backward(forward.rbegin(), forward.rend());
  const Covisibility one = MeasureCovisibility(ModelWithTracks(60, {forward, forward}));
  const Covisibility other = MeasureCovisibility(ModelWithTracks(60, {backward, backward}));
  for (size_t i = 0; i < 60; ++i) {
    ASSERT_EQ(one[i].size(), other[i].size());
    for (size_t k = 0; k < one[i].size(); ++k) {
      EXPECT_EQ(one[i][k].image_idx, other[i][k].image_idx);
      EXPECT_EQ(one[i][k].quality, other[i][k].quality);
    }
  }
}

TEST(MedianParallaxTest, OfTheSharedPoints) {
  SurveyModel survey;
  survey.AddAbove("a", -0.1);
  survey.AddAbove("b", 0.1);
  SparseModel model = survey.WithPoints({});
  const double ranges[] = {1, 2, 4};
  for (int i = 0; i < 2; ++i) {
    PosedImage& image = model.images[static_cast<size_t>(i)];
    image.point3D_ids = {kNoPoint3D, 1, 2, 3};
    image.point3D_ids.push_back(i == 0 ? 8 : 9);  // not shared
  }
  for (uint64_t id = 1; id <= 3; ++id) model.points3D[id].xyz = {0, 0, ranges[id - 1]};
  model.points3D[8].xyz = model.points3D[9].xyz = {0, 0, 0.01};
  EXPECT_EQ(NumSharedPoints(model.images[0], model.images[1]), 3);
  EXPECT_NEAR(*MedianParallaxDeg(model, model.images[0], model.images[1]),
              2 * std::atan(0.1 / 2) * 180 / M_PI, 1e-9);
  model.images[1].point3D_ids = {kNoPoint3D};
  EXPECT_EQ(MedianParallaxDeg(model, model.images[0], model.images[1]), std::nullopt);
  EXPECT_EQ(NumSharedPoints(model.images[0], model.images[1]), 0);
}

}  // namespace
}  // namespace colmap_seapoint
