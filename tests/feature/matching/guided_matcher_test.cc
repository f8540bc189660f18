#include "feature/matching/guided_matcher.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <set>

#include "feature/match_features.h"
#include "feature/matching/hamming_matcher.h"

namespace colmap_seapoint {
namespace {

constexpr int kNumLooks = 40;  // of the SeaPoints that repeat themselves

// Points of a seabed with some relief, seen twice from above: the first `num_plain` look like
// nothing else, of the others about 30 each look alike.
struct Scene {
  Camera camera = MakeCamera(CameraModel::kOpenCV, 1200, 1360, 1024);
  Features features1, features2;
  FeatureMatches truth;  // every point with itself
  TwoViewGeometry geometry;
};

Descriptor RandomDescriptor(std::mt19937* generator) {
  Descriptor descriptor;
  for (uint8_t& byte : descriptor) byte = static_cast<uint8_t>((*generator)());
  return descriptor;
}

Scene MakeScene(uint32_t num_plain, uint32_t num_repetitive) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> x(20, 1340), y(20, 1004), noise(-0.3, 0.3);
  std::vector<Descriptor> looks;
  for (int i = 0; i < kNumLooks; ++i) looks.push_back(RandomDescriptor(&generator));
  Rigid3d pose;
  pose.rotation = Eigen::AngleAxisd(0.03, Eigen::Vector3d(0.2, 0.4, 1).normalized());
  pose.translation = Eigen::Vector3d(-0.35, 0.03, 0.02);
  Scene scene;
  for (uint32_t i = 0; i < num_plain + num_repetitive; ++i) {
    const Eigen::Vector2d pixel1(x(generator), y(generator));
    const double depth = 2 + 0.1 * std::sin(pixel1.x() / 90) * std::cos(pixel1.y() / 70);
    const Eigen::Vector3d point = depth * scene.camera.CamFromImg(pixel1)->homogeneous();
    const Eigen::Vector2d pixel2 = *scene.camera.ImgFromCam(pose * point);
    SeaPoint at1, at2;
    at1.x = static_cast<float>(pixel1.x());
    at1.y = static_cast<float>(pixel1.y());
    at2.x = static_cast<float>(pixel2.x() + noise(generator));
    at2.y = static_cast<float>(pixel2.y() + noise(generator));
    scene.features1.points.push_back(at1);
    scene.features2.points.push_back(at2);
    const Descriptor look = i < num_plain ? RandomDescriptor(&generator) : looks[i % kNumLooks];
    for (Features* features : {&scene.features1, &scene.features2}) {
      Descriptor seen = look;
      for (int flips = 0; flips < 12; ++flips) seen[generator() % 32] ^= 1u << generator() % 8;
      features->descriptors.push_back(seen);
    }
    scene.truth.push_back({i, i});
  }
  Eigen::Matrix3d cross;
  const Eigen::Vector3d t = pose.translation.normalized();
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  scene.geometry.config = TwoViewConfig::kCalibrated;
  scene.geometry.E = cross * pose.rotation.toRotationMatrix();
  scene.geometry.inliers.assign(scene.truth.begin(), scene.truth.begin() + num_plain);
  return scene;
}

FeatureMatches Guide(const Scene& scene, const GuidedMatcherOptions& options = {}) {
  return MatchGuided(scene.camera, scene.features1, scene.camera, scene.features2,
                     scene.geometry.inliers, scene.geometry, options);
}

TEST(GuidedMatcherTest, FindsWhatLooksLikeManyOthers) {
  Scene scene = MakeScene(400, 1200);
  // By looks alone next to none of them is found.
  const FeatureMatches by_looks = MatchHamming(
      scene.features1.descriptors, scene.features2.descriptors, HammingMatcherOptions());
  const auto num_right = std::count_if(by_looks.begin(), by_looks.end(), [](const FeatureMatch& m) {
    return m.idx1 >= 400 && m.idx1 == m.idx2;
  });
  EXPECT_LT(num_right, 150);

  for (const bool by_rays : {true, false}) {
    if (!by_rays) {
      Eigen::Matrix3d inverse_k = Eigen::Matrix3d::Identity();
      inverse_k(0, 0) = inverse_k(1, 1) = 1.0 / 1200;
      inverse_k(0, 2) = -680.0 / 1200;
      inverse_k(1, 2) = -512.0 / 1200;
      scene.geometry.F = inverse_k.transpose() * *scene.geometry.E * inverse_k;
      scene.geometry.E.reset();
    }
    const FeatureMatches added = Guide(scene);
    EXPECT_GE(added.size(), 1130u);
    std::set<uint32_t> seen1, seen2;
    size_t num_good = 0;
    for (size_t i = 0; i < added.size(); ++i) {
      EXPECT_GE(added[i].idx1, 400u);  // what is matched stays as it is
      EXPECT_TRUE(seen1.insert(added[i].idx1).second && seen2.insert(added[i].idx2).second);
      num_good += added[i].idx1 == added[i].idx2;
    }
    EXPECT_GE(num_good, added.size() * 99 / 100);
    EXPECT_TRUE(std::is_sorted(added.begin(), added.end(),
                               [](const auto& a, const auto& b) { return a.idx1 < b.idx1; }));
  }
}

TEST(GuidedMatcherTest, WhatLooksDifferentOrLiesElsewhereIsNotTaken) {
  Scene scene = MakeScene(400, 300);
  std::mt19937 generator(12);
  for (uint32_t i = 400; i < 500; ++i) {
    scene.features2.descriptors[i] = RandomDescriptor(&generator);
  }
  for (uint32_t i = 500; i < 600; ++i) scene.features2.points[i].y += 4;  // off its epipolar line
  const FeatureMatches added = Guide(scene);
  EXPECT_LE(std::count_if(added.begin(), added.end(),
                          [](const FeatureMatch& match) { return match.idx1 < 600; }),
            4);
  EXPECT_GE(added.size(), 94u);
}

TEST(GuidedMatcherTest, AddsNothingWithoutGeometry) {
  const Scene scene = MakeScene(400, 300);
  GuidedMatcherOptions off;
  off.enabled = false;
  EXPECT_TRUE(Guide(scene, off).empty());
  Scene unknown = scene;
  unknown.geometry.E.reset();
  EXPECT_TRUE(Guide(unknown).empty());
  Scene few = scene;
  few.geometry.inliers.resize(19);
  EXPECT_TRUE(Guide(few).empty());
  Scene empty = scene;
  empty.features1 = Features();
  empty.geometry.inliers.clear();
  EXPECT_TRUE(Guide(empty).empty());
}

// Through the whole spine: guided matches stand among `matches` and among the inliers.
TEST(GuidedMatcherTest, MatchFeaturesHoldsThemInBothLists) {
  const Scene scene = MakeScene(500, 500);
  SeaPointMatchingOptions options;
  const MatchedPair with =
      MatchFeatures(scene.camera, scene.features1, scene.camera, scene.features2, options);
  options.guided.enabled = false;
  const MatchedPair without =
      MatchFeatures(scene.camera, scene.features1, scene.camera, scene.features2, options);
  EXPECT_GE(without.geometry.inliers.size(), 480u);
  EXPECT_GE(with.geometry.inliers.size(), without.geometry.inliers.size() + 300);
  EXPECT_EQ(with.matches.size() - without.matches.size(),
            with.geometry.inliers.size() - without.geometry.inliers.size());
  for (const FeatureMatch& inlier : with.geometry.inliers) {
    EXPECT_NE(std::find(with.matches.begin(), with.matches.end(), inlier), with.matches.end());
  }
  for (const FeatureMatches* list : {&with.matches, &with.geometry.inliers}) {
    for (size_t i = 1; i < list->size(); ++i) {
      EXPECT_LT((*list)[i - 1].idx1, (*list)[i].idx1);
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
