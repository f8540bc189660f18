#include "feature/extract_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "feature/descriptor/rbrief_descriptor.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

GrayImage TexturedPicture(int width, int height, double spacing = 24) {
  const NoiseTexture texture(5, spacing, 4);
  GrayImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = 127 + 90 * texture.At({x + 0.5, y + 0.5, 0.3});
      picture.At(x, y) = static_cast<uint8_t>(std::clamp(value, 0.0, 255.0));
    }
  }
  return picture;
}

SeaPointExtractionOptions Interval(int min_count, int max_count, int num_levels = 1) {
  SeaPointExtractionOptions options;
  options.min_num_features = min_count;
  options.max_num_features = max_count;
  options.num_levels = num_levels;
  return options;
}

TEST(ExtractFeaturesTest, CountLiesInTheIntervalAndPointsInsideTheBorder) {
  const GrayImage picture = TexturedPicture(400, 300);
  const ExtractedFeatures result = ExtractFeatures(picture, GrayImage(), Interval(200, 240));
  ASSERT_EQ(result.detection.size(), 1u);
  EXPECT_EQ(result.detection[0].status, ThresholdStatus::kConverged);
  EXPECT_GE(result.features.points.size(), 200u);
  EXPECT_LE(result.features.points.size(), 240u);
  EXPECT_EQ(result.features.points.size(), result.features.descriptors.size());
  for (const SeaPoint& point : result.features.points) {
    EXPECT_GE(point.x, kRBriefBorder);
    EXPECT_GE(point.y, kRBriefBorder);
    EXPECT_LE(point.x, 400 - kRBriefBorder);
    EXPECT_LE(point.y, 300 - kRBriefBorder);
    EXPECT_EQ(point.scale, 1);
  }
}

TEST(ExtractFeaturesTest, SameBytesEveryTime) {
  const GrayImage picture = TexturedPicture(300, 260);
  const Features a = ExtractFeatures(picture, GrayImage(), Interval(150, 200, 2)).features;
  const Features b = ExtractFeatures(picture, GrayImage(), Interval(150, 200, 2)).features;
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_EQ(a.descriptors, b.descriptors);
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].x, b.points[i].x);
    EXPECT_EQ(a.points[i].orientation, b.points[i].orientation);
  }
}

TEST(ExtractFeaturesTest, FlatAndTinyPicturesHaveNone) {
  for (const GrayImage& picture :
       {GrayImage(300, 300, 1, 90), GrayImage(), GrayImage(2 * kRBriefBorder, 500, 1, 3)}) {
    const ExtractedFeatures result = ExtractFeatures(picture, GrayImage(), Interval(10, 20, 3));
    EXPECT_TRUE(result.features.points.empty());
    EXPECT_TRUE(result.features.descriptors.empty());
    EXPECT_EQ(result.detection.size(), picture.width == 300 ? 3u : 0u);
    for (const DetectionSummary& level : result.detection) {
      EXPECT_EQ(level.status, ThresholdStatus::kFlat);
    }
  }
}

TEST(ExtractFeaturesTest, LevelsShareTheIntervalByArea) {
  const GrayImage picture = TexturedPicture(641, 479, 40);
  const ExtractedFeatures result = ExtractFeatures(picture, GrayImage(), Interval(350, 420, 3));
  std::map<int, int> count_of_level;
  float right_most = 0;
  for (const SeaPoint& point : result.features.points) {
    ++count_of_level[static_cast<int>(std::lround(2 * std::log2(point.scale)))];
    right_most = std::max(right_most, point.x);
    // Full-size pixels, and the border of the level it was found on.
    EXPECT_GE(point.x, kRBriefBorder * point.scale * 0.99f);
    EXPECT_LE(point.x, 641 - kRBriefBorder * point.scale * 0.99f);
    EXPECT_LE(point.y, 479 - kRBriefBorder * point.scale * 0.99f);
  }
  ASSERT_EQ(count_of_level.size(), 3u);  // 4/7, 2/7 and 1/7 of 350 to 420
  EXPECT_TRUE(count_of_level[0] >= 199 && count_of_level[0] <= 240) << count_of_level[0];
  EXPECT_TRUE(count_of_level[1] >= 99 && count_of_level[1] <= 120) << count_of_level[1];
  EXPECT_TRUE(count_of_level[2] >= 49 && count_of_level[2] <= 60) << count_of_level[2];
  EXPECT_GT(right_most, 560);
}

// One spot in an empty picture is found at the same full-size place on every level.
TEST(ExtractFeaturesTest, EveryLevelPutsASpotWhereItIs) {
  const double x0 = 201.3, y0 = 150.8;
  GrayImage picture(403, 301);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double squared = std::pow(x + 0.5 - x0, 2) + std::pow(y + 0.5 - y0, 2);
      picture.At(x, y) = static_cast<uint8_t>(std::lround(20 + 200 * std::exp(-squared / 12.5)));
    }
  }
  SeaPointExtractionOptions options = Interval(1, 1000, 3);
  options.nms_radius = 30;
  const Features features = ExtractFeatures(picture, GrayImage(), options).features;
  ASSERT_EQ(features.points.size(), 3u);
  for (const SeaPoint& point : features.points) {
    EXPECT_NEAR(point.x, x0, 0.25 * point.scale) << point.scale;
    EXPECT_NEAR(point.y, y0, 0.25 * point.scale) << point.scale;
  }
}

TEST(ExtractFeaturesTest, MaskHoldsOnEveryLevel) {
  const GrayImage picture = TexturedPicture(500, 400);
  GrayImage mask(500, 400, 1, 255);
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 250; ++x) mask.At(x, y) = 0;
  }
  const Features features = ExtractFeatures(picture, mask, Interval(100, 150, 3)).features;
  ASSERT_GT(features.points.size(), 90u);
  for (const SeaPoint& point : features.points) {
    EXPECT_GT(point.x, 250 - 1.5 * point.scale) << point.scale;
  }
}

// Its own SeaPoints stand first, as they are without it; then levels that follow each other: from
// the next one on in a small picture, from 0.75 megapixels on in a large one.
TEST(ExtractSecondChanceTest, AddsCoarserLevels) {
  for (const auto& [width, height, first_scale] :
       {std::tuple{640, 480, std::sqrt(2.0)}, std::tuple{1600, 1200, 2.0}}) {
    const GrayImage picture = TexturedPicture(width, height);
    const Features usual = ExtractFeatures(picture, GrayImage(), Interval(350, 420)).features;
    const Features more = ExtractSecondChance(picture, GrayImage(), Interval(350, 420));
    ASSERT_GT(more.points.size(), usual.points.size());
    ASSERT_EQ(more.points.size(), more.descriptors.size());
    for (size_t i = 0; i < usual.points.size(); ++i) {
      EXPECT_EQ(more.points[i].x, usual.points[i].x);
      EXPECT_EQ(more.points[i].scale, 1);
      EXPECT_TRUE(more.descriptors[i] == usual.descriptors[i]);
    }
    EXPECT_NEAR(more.points[usual.points.size()].scale, first_scale, 0.02);
    for (size_t i = usual.points.size() + 1; i < more.points.size(); ++i) {
      EXPECT_LT(more.points[i].scale, 1.5f * more.points[i - 1].scale);
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
