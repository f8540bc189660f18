#include "feature/detector/seapoint_detector.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/feature/detector/detector_oracle.h"
#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

GrayImage RandomPicture(int width, int height, unsigned seed) {
  std::mt19937 generator(seed);
  GrayImage picture(width, height);
  for (uint8_t& value : picture.data) value = static_cast<uint8_t>(generator());
  return picture;
}

// Squares of two grey levels: the strongest gradients there are, and many equal measures.
GrayImage Checkerboard(int width, int height, int side, int low, int high) {
  GrayImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.At(x, y) = static_cast<uint8_t>((x / side + y / side) % 2 ? high : low);
    }
  }
  return picture;
}

// Few grey levels and soft blobs.
GrayImage Blobs(int width, int height, unsigned seed) {
  std::mt19937 generator(seed);
  GrayImage picture(width, height, 1, 40);
  for (int blob = 0; blob < 25; ++blob) {
    const int cx = static_cast<int>(generator() % static_cast<unsigned>(width));
    const int cy = static_cast<int>(generator() % static_cast<unsigned>(height));
    const int radius = 2 + static_cast<int>(generator() % 6), level = 60 + 8 * blob;
    for (int y = std::max(0, cy - radius); y < std::min(height, cy + radius); ++y) {
      for (int x = std::max(0, cx - radius); x < std::min(width, cx + radius); ++x) {
        picture.At(x, y) = static_cast<uint8_t>(level);
      }
    }
  }
  return picture;
}

struct NamedPicture {
  const char* name;
  GrayImage picture;
};

std::vector<NamedPicture> Pictures() {
  return {{"random", RandomPicture(83, 61, 1)},
          {"random, odd sizes", RandomPicture(67, 90, 2)},
          {"blobs", Blobs(97, 71, 3)},
          {"hard checkerboard", Checkerboard(80, 64, 5, 0, 255)},
          {"soft checkerboard", Checkerboard(72, 72, 9, 100, 110)}};
}

std::vector<HarrisOptions> HarrisSettings() {
  return {{2.0, 7, 0.04}, {0, 3, 0.04}, {0, 11, 0}, {1.0, 5, 0.25}, {4.0, 11, 0.06}, {0.1, 3, 0.1}};
}

TEST(HarrisMeasureTest, EqualsTheDefinitionBitForBit) {
  for (const NamedPicture& named : Pictures()) {
    for (const HarrisOptions& options : HarrisSettings()) {
      SCOPED_TRACE(named.name + std::string(", sigma ") + std::to_string(options.smoothing_sigma) +
                   ", window " + std::to_string(options.window_size));
      const FloatImage expected = OracleHarrisMeasure(named.picture, options);
      ForEachVectorTarget(
          [&] { EXPECT_EQ(HarrisMeasure(named.picture, options).data, expected.data); });
    }
  }
}

// The sums are integers: the largest that can be must not overflow. Columns of three greys give
// the largest gradient in every pixel.
TEST(HarrisMeasureTest, StrongestGradientsDoNotOverflow) {
  GrayImage stripes(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) stripes.At(x, y) = (x / 2 + y / 2) % 2 ? 255 : 0;
  }
  for (const double k : {0.0, 0.04}) {
    const HarrisOptions options = {0, 11, k};
    const FloatImage map = HarrisMeasure(stripes, options);
    const FloatImage expected = OracleHarrisMeasure(stripes, options);
    ForEachVectorTarget([&] { EXPECT_EQ(HarrisMeasure(stripes, options).data, expected.data); });
    EXPECT_GT(map.At(32, 32), 1e8f);
  }
}

TEST(HarrisMeasureTest, BorderIsZeroAndAsWideAsItSays) {
  for (const HarrisOptions& options : HarrisSettings()) {
    const int border = HarrisBorder(options);
    const FloatImage map = HarrisMeasure(RandomPicture(90, 80, 4), options);
    int num_zero_inside = 0;
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        const bool inside = x >= border && y >= border && x < 90 - border && y < 80 - border;
        if (inside) {
          num_zero_inside += map.At(x, y) == 0;
        } else {
          ASSERT_EQ(map.At(x, y), 0) << x << " " << y;
        }
      }
    }
    EXPECT_LT(num_zero_inside, 5);
  }
}

TEST(HarrisMeasureTest, SmallerThanItsBorderIsAllZero) {
  const HarrisOptions options = {2.0, 7, 0.04};
  const int border = HarrisBorder(options);
  for (const int size : {0, 1, border, 2 * border}) {
    const FloatImage map = HarrisMeasure(RandomPicture(size, 40, 5), options);
    EXPECT_EQ(map.data, FloatImage(size, 40).data);
  }
  const FloatImage map = HarrisMeasure(RandomPicture(2 * border + 1, 2 * border + 1, 5), options);
  EXPECT_NE(map.At(border, border), 0);
}

void ExpectSamePoints(const std::vector<SeaPoint>& actual, const std::vector<SeaPoint>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (size_t i = 0; i < actual.size(); ++i) {
    ASSERT_NEAR(actual[i].x, expected[i].x, 1e-4) << i;
    ASSERT_NEAR(actual[i].y, expected[i].y, 1e-4) << i;
  }
}

TEST(SeaPointDetectorTest, EqualsThePaperWordByWord) {
  for (const NamedPicture& named : Pictures()) {
    for (const int radius : {1, 2, 4}) {
      for (const int min_count : {1, 10, 40}) {
        SCOPED_TRACE(named.name + std::string(", radius ") + std::to_string(radius) + ", minimum " +
                     std::to_string(min_count));
        SeaPointExtractionOptions options;
        options.light_balance = 0;  // the paper
        options.nms_radius = radius;
        options.min_num_features = min_count;
        options.max_num_features = min_count + 2;
        options.smoothing_sigma = 1;
        options.window_size = 5;
        const auto points = DetectSeaPoints(named.picture, GrayImage(), options, 10).points;
        ExpectSamePoints(points, OracleDetect(named.picture, GrayImage(), options, 10));
      }
    }
  }
}

// A checkerboard's crossings are all alike: a plateau of equal measures has one point only, its
// first in raster order; and equal crossings stand in raster order.
TEST(SeaPointDetectorTest, TiesAreInRasterOrder) {
  SeaPointExtractionOptions options;
  options.light_balance = 0;  // the paper
  options.nms_radius = 3;
  options.min_num_features = 1;
  options.max_num_features = 100000;
  const GrayImage board = Checkerboard(120, 120, 12, 50, 200);
  const auto [points, summary] = DetectSeaPoints(board, GrayImage(), options, 12);
  ASSERT_GE(points.size(), 49u);
  EXPECT_EQ(static_cast<int>(points.size()), summary.num_local_maxima);
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = i + 1; j < points.size(); ++j) {
      EXPECT_GT(std::max(std::abs(points[i].x - points[j].x), std::abs(points[i].y - points[j].y)),
                2.0f);
    }
  }
  options.max_num_features = 7;
  const Detection tied = DetectSeaPoints(board, GrayImage(), options, 12);
  ExpectSamePoints(tied.points, OracleDetect(board, GrayImage(), options, 12));
  EXPECT_EQ(tied.summary.status, ThresholdStatus::kTied);
}

TEST(SeaPointDetectorTest, OfEqualMaximaTheFirstInRasterOrderStays) {
  for (const bool side_by_side : {true, false}) {
    GrayImage picture(90, 90, 1, 50);
    const int dx = side_by_side ? 8 : -3, dy = side_by_side ? 0 : 8;
    for (int y = 40; y < 43; ++y) {
      for (int x = 40; x < 43; ++x) picture.At(x, y) = picture.At(x + dx, y + dy) = 200;
    }
    SeaPointExtractionOptions options;
    options.light_balance = 0;  // the paper
    options.smoothing_sigma = 1;
    options.window_size = 3;
    options.min_num_features = 1;
    options.max_num_features = 100;
    options.nms_radius = 4;
    const auto both = DetectSeaPoints(picture, GrayImage(), options, 10).points;
    options.nms_radius = 20;
    const auto one = DetectSeaPoints(picture, GrayImage(), options, 10).points;
    ASSERT_EQ(one.size(), 1u);
    ASSERT_GE(both.size(), 2u);
    ExpectSamePoints(one, OracleDetect(picture, GrayImage(), options, 10));
    EXPECT_LT(one[0].x, 44);
    EXPECT_LT(one[0].y, 44);
  }
}

TEST(SeaPointDetectorTest, SubPixelFollowsASmoothSpot) {
  for (const double x0 : {40.5, 40.7, 41.0, 40.2}) {
    for (const double y0 : {40.5, 40.9, 40.35}) {
      GrayImage picture(81, 81);
      for (int y = 0; y < 81; ++y) {
        for (int x = 0; x < 81; ++x) {
          const double squared = std::pow(x + 0.5 - x0, 2) + std::pow(y + 0.5 - y0, 2);
          picture.At(x, y) = static_cast<uint8_t>(std::lround(20 + 200 * std::exp(-squared / 8)));
        }
      }
      SeaPointExtractionOptions options;
      options.light_balance = 0;  // the paper
      options.min_num_features = options.max_num_features = 1;
      options.nms_radius = 10;
      const auto points = DetectSeaPoints(picture, GrayImage(), options, 12).points;
      ASSERT_EQ(points.size(), 1u);
      EXPECT_NEAR(points[0].x, x0, 0.1);
      EXPECT_NEAR(points[0].y, y0, 0.1);
    }
  }
}

// To the right the picture gets darker: the same texture with less and less of its contrast.
TEST(SeaPointDetectorTest, BalancedLightFindsWhatLiesInTheDark) {
  GrayImage picture = RandomPicture(600, 300, 12);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 600; ++x) {
      picture.At(x, y) = static_cast<uint8_t>(picture.At(x, y) * (1 - x / 800.0));
    }
  }
  SeaPointExtractionOptions options;
  options.min_num_features = 300;
  options.max_num_features = 320;
  std::vector<double> shares;
  for (const double strength : {0.0, 0.5, 1.0}) {
    options.light_balance = strength;
    const auto [points, summary] = DetectSeaPoints(picture, GrayImage(), options, 16);
    EXPECT_EQ(summary.status, ThresholdStatus::kConverged);
    EXPECT_TRUE(points.size() >= 300 && points.size() <= 320) << points.size();
    EXPECT_LE(summary.num_rounds, 6);
    const auto num_dark = std::count_if(points.begin(), points.end(),
                                        [](const SeaPoint& point) { return point.x > 300; });
    shares.push_back(static_cast<double>(num_dark) / static_cast<double>(points.size()));
  }
  EXPECT_LT(shares[0], 0.02);
  EXPECT_GT(shares[1], shares[0] + 0.05);
  EXPECT_NEAR(shares[2], 0.5, 0.1);
}

// Evenly lit, the balance takes next to nothing away.
TEST(SeaPointDetectorTest, BalanceLeavesEvenLightAlone) {
  const GrayImage picture = RandomPicture(500, 400, 13);
  SeaPointExtractionOptions options;
  options.min_num_features = 300;
  options.max_num_features = 320;
  options.light_balance = 0;
  const auto plain = DetectSeaPoints(picture, GrayImage(), options, 16).points;
  options.light_balance = 0.5;
  const auto balanced = DetectSeaPoints(picture, GrayImage(), options, 16).points;
  const auto num_kept = std::count_if(plain.begin(), plain.end(), [&](const SeaPoint& point) {
    return std::any_of(balanced.begin(), balanced.end(), [&](const SeaPoint& other) {
      return other.x == point.x && other.y == point.y;
    });
  });
  EXPECT_GE(num_kept, 250);
}

TEST(SeaPointDetectorTest, FlatPictureHasNone) {
  SeaPointExtractionOptions options;
  options.light_balance = 0;  // the paper
  for (const int level : {0, 127, 255}) {
    const GrayImage flat(100, 100, 1, static_cast<uint8_t>(level));
    const auto [points, summary] = DetectSeaPoints(flat, GrayImage(), options, 10);
    EXPECT_TRUE(points.empty());
    EXPECT_EQ(summary.status, ThresholdStatus::kFlat);
    EXPECT_EQ(summary.num_local_maxima, 0);
  }
  // Straight edges are no corners either.
  GrayImage edge(100, 100, 1, 30);
  for (int y = 0; y < 100; ++y) {
    for (int x = 50; x < 100; ++x) edge.At(x, y) = 220;
  }
  const auto [points, summary] = DetectSeaPoints(edge, GrayImage(), options, 10);
  EXPECT_TRUE(points.empty());
  EXPECT_EQ(summary.status, ThresholdStatus::kFlat);
}

TEST(SeaPointDetectorTest, BorderAndMaskKeepPointsOut) {
  const GrayImage picture = RandomPicture(150, 120, 6);
  GrayImage mask(150, 120, 1, 1);
  for (int y = 0; y < 120; ++y) {
    for (int x = 60; x < 100; ++x) mask.At(x, y) = 0;
  }
  SeaPointExtractionOptions options;
  options.light_balance = 0;  // the paper
  options.nms_radius = 2;
  options.min_num_features = 20;
  options.max_num_features = 100000;
  const int harris_border =
      HarrisBorder({options.smoothing_sigma, options.window_size, options.harris_k});
  for (const int border : {0, 20, 50}) {
    const auto points = DetectSeaPoints(picture, mask, options, border).points;
    EXPECT_FALSE(points.empty());
    for (const SeaPoint& point : points) {
      EXPECT_FALSE(point.x >= 60.5 && point.x < 99.5) << point.x;
      EXPECT_TRUE(point.x >= border && point.x <= 150 - border) << point.x;
      EXPECT_TRUE(point.y >= border && point.y <= 120 - border) << point.y;
    }
    ExpectSamePoints(points,
                     OracleDetect(picture, mask, options, std::max(border, harris_border + 1)));
  }
  const auto [points, summary] = DetectSeaPoints(picture, GrayImage(150, 120), options, 0);
  EXPECT_TRUE(points.empty());
  EXPECT_EQ(summary.status, ThresholdStatus::kFlat);
}

TEST(SeaPointDetectorTest, PictureSmallerThanTheBorder) {
  SeaPointExtractionOptions options;
  options.light_balance = 0;  // the paper
  for (const int size : {0, 1, 3, 15, 56}) {
    const GrayImage picture = RandomPicture(size, size, 7);
    EXPECT_TRUE(DetectSeaPoints(picture, GrayImage(), options, 28).points.empty()) << size;
  }
}

}  // namespace
}  // namespace colmap_seapoint
