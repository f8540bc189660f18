// Pictures with coarser levels: nothing that the finest level ties is lost by them.
#include "feature/match_levels.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "feature/feature_levels.h"

namespace colmap_seapoint {
namespace {

Descriptor RandomDescriptor(std::mt19937* random) {
  Descriptor descriptor;
  for (uint8_t& byte : descriptor) byte = static_cast<uint8_t>((*random)());
  return descriptor;
}

// Two cameras side by side before points in space. On the finest level only the first points can
// be told in both pictures; on level 4 the others.
class MatchLevelsTest : public testing::Test {
 protected:
  void Add(int count, float scale, bool alike) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d point(1.1 * uniform(random_), 0.8 * uniform(random_),
                                  4 + uniform(random_));
      const Descriptor descriptor = RandomDescriptor(&random_);
      Put(point, scale, descriptor, &features1_);
      Put(point - Eigen::Vector3d(0.3, 0, 0), scale,
          alike ? descriptor : RandomDescriptor(&random_), &features2_);
    }
  }

  void Put(const Eigen::Vector3d& point, float scale, const Descriptor& descriptor,
           Features* features) {
    const auto pixel = camera_.ImgFromCam(point);
    SeaPoint sea_point;
    sea_point.x = static_cast<float>(pixel->x());
    sea_point.y = static_cast<float>(pixel->y());
    sea_point.scale = scale;
    features->points.push_back(sea_point);
    features->descriptors.push_back(descriptor);
  }

  MatchedPair Match(double min_share = 0) const {
    return MatchLevels(camera_, features1_, camera_, features2_, options_, min_share);
  }

  std::mt19937 random_{5};
  const Camera camera_ = MakeCamera(CameraModel::kPinhole, 2000, 2400, 1800);
  SeaPointMatchingOptions options_;
  Features features1_, features2_;
};

void ExpectOneToOneAndSorted(const FeatureMatches& matches) {
  std::set<uint32_t> seen1, seen2;
  for (size_t i = 0; i < matches.size(); ++i) {
    EXPECT_TRUE(seen1.insert(matches[i].idx1).second);
    EXPECT_TRUE(seen2.insert(matches[i].idx2).second);
    if (i == 0) continue;
    EXPECT_LT(matches[i - 1].idx1, matches[i].idx1);
  }
}

TEST_F(MatchLevelsTest, OneLevelIsMatchedAsEver) {
  Add(200, 1, true);
  const MatchedPair expected = MatchFeatures(camera_, features1_, camera_, features2_, options_);
  const MatchedPair pair = Match();
  EXPECT_TRUE(pair.matches == expected.matches);
  EXPECT_TRUE(pair.geometry.inliers == expected.geometry.inliers);
  EXPECT_GT(pair.geometry.inliers.size(), 100u);
}

TEST_F(MatchLevelsTest, WhatTheCoarseLevelTiesComesOnTop) {
  Add(150, 1, true);
  const size_t num_finest = Match().geometry.inliers.size();
  ASSERT_GT(num_finest, 100u);
  Add(150, 4, true);
  const MatchedPair pair = Match();
  EXPECT_GT(pair.geometry.inliers.size(), num_finest + 100);
  ExpectOneToOneAndSorted(pair.matches);
  ExpectOneToOneAndSorted(pair.geometry.inliers);
  for (const FeatureMatch& match : pair.geometry.inliers) EXPECT_EQ(match.idx1, match.idx2);
}

TEST_F(MatchLevelsTest, ACoarseLevelAloneTiesAPairInFullPixels) {
  Add(150, 1, false);
  Add(150, 4, true);
  const MatchedPair pair = Match();
  ASSERT_GT(pair.geometry.inliers.size(), 100u);
  for (const FeatureMatch& match : pair.geometry.inliers) EXPECT_GE(match.idx1, 150u);
  ASSERT_TRUE(pair.geometry.cam2_from_cam1);
  EXPECT_GT(std::abs(pair.geometry.cam2_from_cam1->translation.x()), 0.98);
}

TEST_F(MatchLevelsTest, CoarseLevelsOfNoUseChangeNothing) {
  Add(150, 1, true);
  const MatchedPair before = Match();
  Add(300, 4, false);
  const MatchedPair after = Match();
  EXPECT_TRUE(after.geometry.inliers == before.geometry.inliers);
  // Where one picture has none, its partner's do not count either.
  features1_ = Slice(features1_, 0, 150);
  EXPECT_TRUE(Match().geometry.inliers == before.geometry.inliers);
}

TEST_F(MatchLevelsTest, AContradictionOfTheCoarseLevelDoesNotCostTheFinest) {
  Add(150, 1, true);
  const size_t num_finest = Match().geometry.inliers.size();
  // Another scene on the coarse level, seen by cameras that stand otherwise, and fewer points.
  const size_t begin = features1_.points.size();
  Add(60, 4, true);
  for (size_t i = begin; i < features2_.points.size(); ++i) features2_.points[i].y += 150;
  EXPECT_GE(Match().geometry.inliers.size(), num_finest);
}

TEST_F(MatchLevelsTest, EmptyPicturesAndSharesNobodyReaches) {
  EXPECT_TRUE(Match().matches.empty());
  Add(150, 1, true);
  Add(150, 4, true);
  EXPECT_TRUE(Match(1.1).geometry.inliers.empty());
  EXPECT_FALSE(Match(1.1).matches.empty());
}

TEST(FeatureLevels, RunsEndAtGaps) {
  const auto with_scales = [](const std::vector<float>& scales) {
    Features features;
    for (const float scale : scales) {
      features.points.push_back({0, 0, scale, 0});
      features.descriptors.emplace_back();
    }
    return features;
  };
  EXPECT_EQ(CoarsestRunBegin(with_scales({})), 0u);
  EXPECT_EQ(CoarsestRunBegin(with_scales({1, 1, 1})), 0u);
  EXPECT_EQ(CoarsestRunBegin(with_scales({1, 1, 1.41f, 2, 2.83f})), 0u);
  EXPECT_EQ(CoarsestRunBegin(with_scales({1, 1, 2, 2.83f, 4})), 2u);
  EXPECT_EQ(CoarsestRunBegin(with_scales({1, 4.01f, 5.65f})), 1u);
  EXPECT_EQ(NumFinest(with_scales({})), 0u);
  EXPECT_EQ(NumFinest(with_scales({1, 1, 4})), 2u);
  EXPECT_EQ(NumFinest(with_scales({1, 1})), 2u);
}

}  // namespace
}  // namespace colmap_seapoint
