// Patches of a made-up texture that is known at every position, so that pictures of it are exact
// but for the rounding to whole grey values.
#include "feature/remeasuring/patch_matching.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

constexpr int kSize = 64;    // of a picture
constexpr int kMiddle = 32;  // the patch's pixel in the reference

// Plane waves 5 to 25 pixels long: nothing finer than a picture holds.
class Texture {
 public:
  explicit Texture(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int k = 0; k < 24; ++k) {
      const double length = 5 * std::pow(5.0, unit(random)), angle = 2 * M_PI * unit(random);
      waves_.push_back({2 * M_PI / length * Eigen::Vector2d(std::cos(angle), std::sin(angle)),
                        2 * M_PI * unit(random)});
    }
  }
  double At(const Eigen::Vector2d& place) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::cos(wave.frequency.dot(place) + wave.phase);
    return 128 + 8 * sum;
  }
  Eigen::Vector2d GradientAt(const Eigen::Vector2d& place) const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Wave& wave : waves_) {
      sum -= 8 * std::sin(wave.frequency.dot(place) + wave.phase) * wave.frequency;
    }
    return sum;
  }

 private:
  struct Wave {
    Eigen::Vector2d frequency;
    double phase;
  };
  std::vector<Wave> waves_;
};

struct Look {
  PredictedPlace place;  // of the reference patch's middle
  double gain = 1, offset = 0, noise = 0;
  unsigned seed = 1;
};

const Eigen::Vector2d kReferenceMiddle(kMiddle + 0.5, kMiddle + 0.5);

GrayImage Draw(const Texture& texture, const Look& look) {
  GrayImage picture(kSize, kSize);
  std::mt19937 random(look.seed);
  std::normal_distribution<double> noise(0, 1);
  const Eigen::Matrix2d reference_from_other = look.place.other_from_reference.inverse();
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Eigen::Vector2d from_middle = Eigen::Vector2d(x + 0.5, y + 0.5) - look.place.pixel;
      const double value = texture.At(kReferenceMiddle + reference_from_other * from_middle);
      const double gray =
          128 + look.gain * (value - 128) + look.offset + look.noise * noise(random);
      picture.At(x, y) = static_cast<uint8_t>(std::lround(std::clamp(gray, 0.0, 255.0)));
    }
  }
  return picture;
}

Look Straight(double noise, unsigned seed) {
  Look look;
  look.place.pixel = kReferenceMiddle;
  look.noise = noise;
  look.seed = seed;
  return look;
}

ReferencePatch PatchOf(const Texture& texture, double noise = 0, unsigned seed = 1) {
  return *CutPatch(Draw(texture, Straight(noise, seed)), kMiddle, kMiddle);
}

Eigen::Matrix2d Warp(double a, double b, double c, double d) {
  Eigen::Matrix2d warp;
  warp << a, b, c, d;
  return warp;
}

TEST(MatchPatch, FindsShiftsWithoutBias) {
  constexpr int kNumTextures = 30;
  double squared = 0;
  int num = 0;
  for (const double fraction : {0.0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9}) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (unsigned seed = 0; seed < kNumTextures; ++seed) {
      const Texture texture(seed);
      Look look = Straight(0, 1);
      look.place.pixel += Eigen::Vector2d(fraction, 1 - fraction);
      PredictedPlace predicted;
      predicted.pixel = kReferenceMiddle;
      const PatchMatch match = MatchPatch(PatchOf(texture), Draw(texture, look), predicted);
      ASSERT_EQ(match.status, PatchMatchStatus::kMatched) << seed;
      const Eigen::Vector2d error = match.pixel - look.place.pixel;
      mean += error / kNumTextures;
      squared += error.squaredNorm();
      ++num;
    }
    EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.02) << fraction;
  }
  EXPECT_LT(std::sqrt(squared / num), 0.02);
}

// None of them makes the shortest wave shorter than three pixels.
TEST(MatchPatch, FollowsThePredictedWarp) {
  const Eigen::Matrix2d warps[] = {Warp(0.8, 0.1, -0.05, 0.9), Warp(0.6, -0.6, 0.6, 0.6),
                                   Warp(-0.9, 0.02, 0.1, -0.95), Warp(0.65, 0, 0.2, 0.9)};
  for (const Eigen::Matrix2d& warp : warps) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      const Texture texture(seed);
      Look look = Straight(0, 1);
      look.place = {kReferenceMiddle + Eigen::Vector2d(0.3, -0.45), warp};
      const PatchMatch match =
          MatchPatch(PatchOf(texture), Draw(texture, look), {kReferenceMiddle, warp});
      ASSERT_EQ(match.status, PatchMatchStatus::kMatched) << warp << "\n" << seed;
      EXPECT_LT((match.pixel - look.place.pixel).norm(), 0.05) << warp << "\n" << seed;
    }
  }
}

TEST(MatchPatch, IgnoresGainAndOffset) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Texture texture(seed);
    Look look = Straight(0, 1);
    look.place.pixel += Eigen::Vector2d(-0.37, 0.62);
    look.gain = 0.5;
    look.offset = 45;
    PredictedPlace predicted;
    predicted.pixel = kReferenceMiddle;
    const PatchMatch match = MatchPatch(PatchOf(texture), Draw(texture, look), predicted);
    ASSERT_EQ(match.status, PatchMatchStatus::kMatched);
    EXPECT_LT((match.pixel - look.place.pixel).norm(), 0.03) << seed;
    EXPECT_GT(match.correlation, 0.995);
  }
}

// The least standard deviation that any unbiased measurement can have, of both axes together.
double CramerRao(const Texture& texture, double noise) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  for (int y = -warp::kReach; y <= warp::kReach; ++y) {
    for (int x = -warp::kReach; x <= warp::kReach; ++x) {
      const Eigen::Vector2d gradient = texture.GradientAt(kReferenceMiddle + Eigen::Vector2d(x, y));
      information += gradient * gradient.transpose() / (2 * noise * noise);  // of both pictures
    }
  }
  return std::sqrt(information.inverse().trace());
}

TEST(MatchPatch, IsAsGoodAsTheNoiseAllows) {
  constexpr double kNoise = 5;
  constexpr int kNumTrials = 300;
  double squared = 0, least_squared = 0, told_squared = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (unsigned trial = 0; trial < kNumTrials; ++trial) {
    const Texture texture(trial % 20);
    Look look = Straight(kNoise, 2 * trial + 1001);
    look.place.pixel += Eigen::Vector2d(0.37, 0.21);
    PredictedPlace predicted;
    predicted.pixel = kReferenceMiddle;
    const PatchMatch match =
        MatchPatch(PatchOf(texture, kNoise, 2 * trial + 2000), Draw(texture, look), predicted);
    ASSERT_EQ(match.status, PatchMatchStatus::kMatched);
    const Eigen::Vector2d error = match.pixel - look.place.pixel;
    mean += error / kNumTrials;
    squared += error.squaredNorm();
    told_squared += 2 * match.sigma * match.sigma;  // of the worse axis
    least_squared += std::pow(CramerRao(texture, kNoise), 2);
  }
  EXPECT_LT(std::sqrt(squared / least_squared), 1.2);
  EXPECT_GT(std::sqrt(squared / least_squared), 0.9);  // else the figure itself is wrong
  EXPECT_GT(std::sqrt(told_squared / squared), 0.85);
  EXPECT_LT(std::sqrt(told_squared / squared), 1.5);
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.01);
}

TEST(MatchPatch, ConvergesFromThreePixels) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Texture texture(seed);
    const double angle = 0.7 * seed;
    PredictedPlace predicted;
    predicted.pixel = kReferenceMiddle + 3 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const PatchMatch match =
        MatchPatch(PatchOf(texture), Draw(texture, Straight(2, seed)), predicted);
    ASSERT_EQ(match.status, PatchMatchStatus::kMatched) << seed;
    EXPECT_LT((match.pixel - kReferenceMiddle).norm(), 0.08) << seed;
  }
}

TEST(MatchPatch, SaysSoWhenThePatchIsNotThere) {
  int num_matched = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Texture texture(seed), other(seed + 5000);
    PredictedPlace predicted;
    predicted.pixel = kReferenceMiddle;
    const PatchMatch match = MatchPatch(PatchOf(texture), Draw(other, Straight(0, 1)), predicted);
    num_matched += match.status == PatchMatchStatus::kMatched;
    predicted.pixel += Eigen::Vector2d(9, -7);  // the same texture, but plainly elsewhere
    num_matched += MatchPatch(PatchOf(texture), Draw(texture, Straight(0, 1)), predicted).status ==
                   PatchMatchStatus::kMatched;
  }
  EXPECT_LE(num_matched, 4);
}

TEST(MatchPatch, NeedsTextureInBothDirections) {
  GrayImage flat(kSize, kSize, 1, 100), edge = flat;
  for (int y = 0; y < kSize; ++y) {
    for (int x = kMiddle; x < kSize; ++x) edge.At(x, y) = 160;
  }
  PredictedPlace predicted;
  predicted.pixel = kReferenceMiddle;
  for (const GrayImage& picture : {flat, edge}) {
    const PatchMatch match = MatchPatch(*CutPatch(picture, kMiddle, kMiddle), picture, predicted);
    EXPECT_EQ(match.status, PatchMatchStatus::kNoTexture);
  }
  // The other picture alone may be flat as well: its patch is not like anything.
  const PatchMatch match = MatchPatch(PatchOf(Texture(1)), flat, predicted);
  EXPECT_EQ(match.status, PatchMatchStatus::kUnlike);
}

TEST(MatchPatch, TakesAnyPlaceAndPicture) {
  const Texture texture(3);
  const ReferencePatch patch = PatchOf(texture);
  const GrayImage picture = Draw(texture, Straight(0, 1));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double place : {-1e300, -5.0, 0.0, 12.0, 52.0, 64.0, 1e300, nan}) {
    PredictedPlace predicted;
    predicted.pixel = {place, 32};
    EXPECT_EQ(MatchPatch(patch, picture, predicted).status, PatchMatchStatus::kOutside);
    predicted.pixel = {32, place};
    EXPECT_EQ(MatchPatch(patch, picture, predicted).status, PatchMatchStatus::kOutside);
  }
  for (const double scale : {nan, 1e300, 10.0}) {
    PredictedPlace predicted = {kReferenceMiddle, scale * Eigen::Matrix2d::Identity()};
    EXPECT_EQ(MatchPatch(patch, picture, predicted).status, PatchMatchStatus::kOutside);
  }
  PredictedPlace predicted = {kReferenceMiddle, Eigen::Matrix2d::Zero()};
  EXPECT_NE(MatchPatch(patch, picture, predicted).status, PatchMatchStatus::kMatched);
  EXPECT_EQ(MatchPatch(patch, GrayImage(), predicted).status, PatchMatchStatus::kOutside);
}

TEST(MatchPatch, GoesToTheLastPixelThatItNeeds) {
  const Texture texture(3);
  const ReferencePatch patch = PatchOf(texture);
  for (const double place : {13.6, 49.4}) {  // 11 pixels and their interpolation around it
    Look look = Straight(0, 1);
    look.place.pixel = {place, place};
    PredictedPlace predicted;
    predicted.pixel = look.place.pixel;
    const PatchMatch match = MatchPatch(patch, Draw(texture, look), predicted);
    ASSERT_EQ(match.status, PatchMatchStatus::kMatched) << place;
    EXPECT_LT((match.pixel - look.place.pixel).norm(), 0.03);
  }
}

TEST(MatchPatch, IsTheSameOnEveryVectorUnit) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Texture texture(seed);
    Look look = Straight(4, seed);
    look.place = {kReferenceMiddle + Eigen::Vector2d(1.3, -0.7), Warp(0.9, 0.1, -0.2, 0.8)};
    const GrayImage picture = Draw(texture, look);
    const ReferencePatch patch = PatchOf(texture);
    std::vector<PatchMatch> matches;
    ForEachVectorTarget([&] {
      matches.push_back(MatchPatch(patch, picture, {kReferenceMiddle, Warp(0.95, 0.1, -0.2, 0.8)}));
    });
    EXPECT_EQ(matches[0].status, PatchMatchStatus::kMatched);
    for (const PatchMatch& match : matches) {
      EXPECT_EQ(match.pixel, matches[0].pixel);
      EXPECT_EQ(match.sigma, matches[0].sigma);
      EXPECT_EQ(match.correlation, matches[0].correlation);
    }
  }
}

TEST(CutPatch, MustLieWithinThePicture) {
  GrayImage picture(40, 30);
  for (size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = static_cast<uint8_t>(i % 251);
  EXPECT_FALSE(CutPatch(picture, 7, 15));
  EXPECT_FALSE(CutPatch(picture, 32, 15));
  EXPECT_FALSE(CutPatch(picture, 20, 7));
  EXPECT_FALSE(CutPatch(picture, 20, 22));
  EXPECT_FALSE(CutPatch(GrayImage(), 0, 0));
  const auto patch = CutPatch(picture, 31, 21);
  ASSERT_TRUE(patch);
  EXPECT_EQ(patch->gray.front(), picture.At(23, 13));
  EXPECT_EQ(patch->gray.back(), picture.At(39, 29));
}

}  // namespace
}  // namespace colmap_seapoint
