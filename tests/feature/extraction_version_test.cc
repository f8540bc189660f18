// Guards kExtractionVersion: a change of the SeaPoints or descriptors of an exact picture fails
// here. If the change is meant, raise the version and correct the constants in one commit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "feature/extract_features.h"
#include "tests/feature/golden.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

// The texture takes sums, products and floor only, so the picture is the same on every machine.
GrayImage ExactPicture() {
  const NoiseTexture texture(11, 16, 4);
  GrayImage picture(640, 480);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      // Darker to the right, so that the balance of light has something to do.
      const double value = 127 + 90 * (1 - x / 800.0) * texture.At({x + 0.5, y + 0.5, 0.25});
      picture.At(x, y) = static_cast<uint8_t>(std::clamp(value, 0.0, 255.0));
    }
  }
  return picture;
}

// Orientations come from the C library's arc tangent, whose last bit is not the same everywhere:
// steps of a 64th of a radian. The descriptors do not depend on them.
uint64_t HashOf(const Features& features, bool finest_level_only) {
  GoldenHash hash;
  for (size_t i = 0; i < features.points.size(); ++i) {
    const SeaPoint& point = features.points[i];
    if (finest_level_only && point.scale > 1) continue;
    hash.AddExact(point.x);
    hash.AddExact(point.y);
    hash.AddExact(point.scale);
    hash.Add(std::lround(64 * point.orientation));
    hash.AddBytes(features.descriptors[i].data(), features.descriptors[i].size());
  }
  return hash.Value();
}

// Coarser levels are made by cv::resize, which computes in floating point: whether this OpenCV
// gives the same pixels as the one that the constants were taken with (Debian 12's).
bool ResizesAsRecorded(const GrayImage& picture) {
  cv::Mat resized;
  const cv::Mat source(picture.height, picture.width, CV_8U,
                       const_cast<uint8_t*>(picture.data.data()));
  GoldenHash hash;
  for (const cv::Size& size :
       {cv::Size(453, 339), cv::Size(320, 240), cv::Size(226, 170), cv::Size(160, 120)}) {
    cv::resize(source, resized, size, 0, 0, cv::INTER_AREA);
    hash.AddBytes(resized.data, resized.total());
  }
  constexpr uint64_t kRecorded = 0x0245324B3F551615;
  return hash.Value() == kRecorded;
}

constexpr char kVersionOfTheHashes[] = "3";  // to be raised together with the hashes
constexpr uint64_t kDefaults = 0xEF9C35F56733C8F6;
constexpr uint64_t kFiveLevels = 0xFF2E7ACCCB14CA85;
constexpr uint64_t kFinestOfFive = 0xA3A34C4D7B679398;
constexpr uint64_t kMaskedByThePaper = 0x29AE17601106F9A8;

TEST(ExtractionVersion, StandsForTheSameSeaPoints) {
  ASSERT_STREQ(kExtractionVersion, kVersionOfTheHashes);
  const GrayImage picture = ExactPicture();
  const Features features = ExtractFeatures(picture, {}, SeaPointExtractionOptions()).features;
  EXPECT_GE(features.points.size(), 2500u);
  EXPECT_EQ(HashOf(features, false), kDefaults) << std::hex << HashOf(features, false);
}

TEST(ExtractionVersion, StandsForTheSamePyramid) {
  const GrayImage picture = ExactPicture();
  SeaPointExtractionOptions options;
  options.num_levels = 5;
  const Features features = ExtractFeatures(picture, {}, options).features;
  EXPECT_GE(features.points.size(), 2490u);
  EXPECT_EQ(HashOf(features, true), kFinestOfFive) << std::hex << HashOf(features, true);
  if (!ResizesAsRecorded(picture)) GTEST_SKIP() << "another cv::resize: finest level only";
  EXPECT_EQ(HashOf(features, false), kFiveLevels) << std::hex << HashOf(features, false);
}

TEST(ExtractionVersion, StandsForTheSameWithoutOurAdditions) {
  const GrayImage picture = ExactPicture();
  GrayImage mask(picture.width, picture.height, 1, 255);
  for (int y = 100; y < 300; ++y) std::fill(mask.Row(y) + 200, mask.Row(y) + 400, uint8_t{0});
  SeaPointExtractionOptions options;
  options.min_num_features = 500;
  options.max_num_features = 510;
  options.light_balance = 0;
  options.smoothing_sigma = 1;
  options.window_size = 5;
  options.nms_radius = 4;
  const Features features = ExtractFeatures(picture, mask, options).features;
  EXPECT_GE(features.points.size(), 500u);
  EXPECT_EQ(HashOf(features, false), kMaskedByThePaper) << std::hex << HashOf(features, false);
}

// SIFT comes out of OpenCV's floating point, which takes other instructions on other machines:
// instead of a hash, its mean over all SeaPoints, by direction and by cell, to a 50th of a step.
TEST(ExtractionVersion, StandsForTheSameSift) {
  SeaPointExtractionOptions options;
  options.descriptor = "sift";
  const Features features = ExtractFeatures(ExactPicture(), {}, options).features;
  EXPECT_EQ(HashOf(features, false), kDefaults);
  ASSERT_EQ(features.sift_descriptors.size(), features.points.size());
  std::array<double, 8> by_direction{};
  std::array<double, 16> by_cell{};
  for (const SiftDescriptor& descriptor : features.sift_descriptors) {
    for (size_t k = 0; k < descriptor.size(); ++k) {
      by_direction[k % 8] += descriptor[k] / (16.0 * static_cast<double>(features.points.size()));
      by_cell[k / 8] += descriptor[k] / (8.0 * static_cast<double>(features.points.size()));
    }
  }
  constexpr std::array<double, 8> kByDirection = {42.58, 41.14, 41.69, 41.39,
                                                  43.29, 40.94, 41.18, 42.19};
  constexpr std::array<double, 16> kByCell = {37.55, 41.86, 41.22, 35.80, 42.68, 47.58,
                                              46.84, 40.65, 42.68, 47.53, 46.85, 40.66,
                                              37.73, 41.99, 41.34, 35.85};
  for (size_t k = 0; k < 8; ++k) EXPECT_NEAR(by_direction[k], kByDirection[k], 0.02) << k;
  for (size_t k = 0; k < 16; ++k) EXPECT_NEAR(by_cell[k], kByCell[k], 0.02) << k;
}

}  // namespace
}  // namespace colmap_seapoint
