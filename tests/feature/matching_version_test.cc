// Guards kMatchingVersion: a change of the matches or inliers of an exact pair fails here. If the
// change is meant, raise the version and correct the constants in one commit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "feature/extract_features.h"
#include "feature/match_features.h"
#include "tests/feature/golden.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 480, kHeight = 360;

// Blocks of the ground lie at two depths; the camera moves sideways, by whole pixels: the picture
// is the same on every machine, and so is the epipolar geometry.
GrayImage ExactPicture(bool second) {
  const NoiseTexture texture(23, 20, 4);
  GrayImage picture(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int depth = (x / 120 + y / 120) % 2;
      const double value =
          127 + 90 * texture.At({x + (second ? 24 + 12 * depth : 0) + 0.5, y + 0.5, 0.25});
      picture.At(x, y) = static_cast<uint8_t>(std::clamp(value, 0.0, 255.0));
    }
  }
  return picture;
}

// Not OpenCV's: its floating point is not the same on every machine. Two tests of rBRIEF a number.
SiftDescriptor ExactSift(const Descriptor& descriptor) {
  SiftDescriptor sift;
  for (size_t k = 0; k < sift.size(); ++k) {
    const int bits = descriptor[k / 4] >> (2 * (k % 4)) & 3;
    sift[k] = static_cast<uint8_t>(20 + 25 * (bits % 2 + bits / 2));
  }
  return sift;
}

Features ExactFeatures(bool second, bool with_sift) {
  SeaPointExtractionOptions options;
  options.min_num_features = 600;
  options.max_num_features = 700;
  Features features = ExtractFeatures(ExactPicture(second), {}, options).features;
  for (size_t i = 0; with_sift && i < features.points.size(); ++i) {
    features.sift_descriptors.push_back(ExactSift(features.descriptors[i]));
  }
  return features;
}

Camera ExactCamera(bool calibrated) {
  Camera camera = MakeCamera(CameraModel::kPinhole, 500, kWidth, kHeight);
  camera.has_prior_focal_length = calibrated;
  return camera;
}

uint64_t HashOf(const MatchedPair& pair) {
  GoldenHash hash;
  for (const FeatureMatches& matches : {pair.matches, pair.geometry.inliers}) {
    hash.Add(static_cast<int64_t>(matches.size()));
    for (const FeatureMatch& match : matches) {
      hash.Add(match.idx1);
      hash.Add(match.idx2);
    }
  }
  hash.Add(static_cast<int>(pair.geometry.config));
  return hash.Value();
}

constexpr char kVersionOfTheHashes[] = "5";  // to be raised together with the hashes
constexpr uint64_t kUncalibrated = 0xFAB287F4C3809622;
constexpr uint64_t kCalibrated = 0xF73B80CBA95A9BE5;
constexpr uint64_t kSift = 0xF5E65B60D5367F43;
constexpr uint64_t kRatioWithoutGuide = 0x17633E2DC3E5A8FA;

uint64_t HashOfPair(bool with_sift, bool calibrated, const SeaPointMatchingOptions& options) {
  const Camera camera = ExactCamera(calibrated);
  const MatchedPair pair = MatchFeatures(camera, ExactFeatures(false, with_sift), camera,
                                         ExactFeatures(true, with_sift), options);
  EXPECT_GT(pair.geometry.inliers.size(), 100u);
  // The pose goes through Ceres and OpenCV: its bits are theirs. The camera moves along x.
  EXPECT_TRUE(pair.geometry.cam2_from_cam1.has_value());
  if (pair.geometry.cam2_from_cam1) {
    EXPECT_NEAR(std::abs(pair.geometry.cam2_from_cam1->translation.x()), 1, 0.02);
  }
  return HashOf(pair);
}

TEST(MatchingVersion, StandsForTheSameMatches) {
  ASSERT_STREQ(kMatchingVersion, kVersionOfTheHashes);
  const SeaPointMatchingOptions options;
  EXPECT_EQ(HashOfPair(false, false, options), kUncalibrated)
      << std::hex << HashOfPair(false, false, options);
  EXPECT_EQ(HashOfPair(false, true, options), kCalibrated)
      << std::hex << HashOfPair(false, true, options);
}

TEST(MatchingVersion, StandsForTheSameMatchesBySift) {
  const SeaPointMatchingOptions options;
  EXPECT_EQ(HashOfPair(true, true, options), kSift) << std::hex << HashOfPair(true, true, options);
}

TEST(MatchingVersion, StandsForTheSameMatchesUnderOtherOptions) {
  SeaPointMatchingOptions options;
  options.hamming.max_ratio = 0.8;
  options.hamming.max_distance = 64;
  options.guided.enabled = false;
  EXPECT_EQ(HashOfPair(false, true, options), kRatioWithoutGuide)
      << std::hex << HashOfPair(false, true, options);
}

}  // namespace
}  // namespace colmap_seapoint
