#include "colmap_seapoint/georeference/position_consensus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

using Positions = std::vector<PositionMeasurement>;

constexpr double kPi = 3.14159265358979323846;

// metric_from_model of every test. Turned about the vertical only, so that "down" is -z in both
// frames, but for tests that turn it themselves.
Similarity3d Truth() {
  Similarity3d truth;
  truth.scale = 2.5;
  truth.rotation = Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ());
  truth.translation = {100, -30, 7};
  return truth;
}

Eigen::Vector3d InModel(const Eigen::Vector3d& metres) {
  return Truth().rotation.conjugate() * (metres - Truth().translation) / Truth().scale;
}

// A zigzag in three dimensions; its directions are never all in one plane.
Positions Zigzag(int count) {
  Positions positions;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d metres(95 + 0.5 * i, -30 + (i % 3) * 1.5, 5 + 0.3 * (i % 2));
    positions.push_back({InModel(metres), metres, Eigen::Vector3d::Zero()});
  }
  return positions;
}

Positions Line(int count, const Eigen::Vector3d& step) {
  Positions positions;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d metres = Eigen::Vector3d(95, -30, 5) + i * step;
    positions.push_back({InModel(metres), metres, Eigen::Vector3d::Zero()});
  }
  return positions;
}

// A disturbance of about `size` metres, without a random number.
Eigen::Vector3d Wobble(size_t i, double size) {
  const double x = 2.4 * static_cast<double>(i);
  return size * Eigen::Vector3d(std::sin(x), std::cos(1.7 * x), std::sin(3.1 * x + 1));
}

void ExpectTruth(const std::optional<PositionConsensus>& consensus, double tolerance) {
  ASSERT_TRUE(consensus);
  EXPECT_NEAR(consensus->metric_from_model.scale, Truth().scale, tolerance);
  EXPECT_LT(consensus->metric_from_model.rotation.angularDistance(Truth().rotation), tolerance);
}

size_t NumInliers(const PositionConsensus& consensus) {
  return static_cast<size_t>(
      std::count(consensus.is_inlier.begin(), consensus.is_inlier.end(), true));
}

TEST(PositionConsensusTest, ExactPositionsAllAgree) {
  // Up to 26 positions every sample of three is tried, then 3000 drawn ones.
  for (const int count : {3, 4, 5, 8, 26, 40}) {
    const auto consensus = FindPositionConsensus(Zigzag(count), std::nullopt, 0);
    ExpectTruth(consensus, 1e-9);
    EXPECT_EQ(NumInliers(*consensus), static_cast<size_t>(count));
    EXPECT_LT(consensus->sigma_factor, 1e-6);
  }
}

TEST(PositionConsensusTest, NearlyHalfMayBeWrong) {
  for (const int count : {9, 40}) {
    Positions positions = Zigzag(count);
    const size_t num_wrong = static_cast<size_t>(count) / 2 - 1;
    for (size_t i = 0; i < num_wrong; ++i) {
      positions[2 * i].metres += Eigen::Vector3d(3, -2, 1) + Wobble(i, 2);
    }
    const auto consensus = FindPositionConsensus(positions, std::nullopt, 0);
    ExpectTruth(consensus, 1e-9);
    for (size_t i = 0; i < positions.size(); ++i) {
      EXPECT_EQ(consensus->is_inlier[i], i >= 2 * num_wrong || i % 2 == 1) << i << " of " << count;
    }
  }
}

TEST(PositionConsensusTest, FewerThanFiveCannotSayWhoIsWrong) {
  Positions positions = Zigzag(4);
  positions[1].metres.x() += 2;
  const auto consensus = FindPositionConsensus(positions, std::nullopt, 0);
  ASSERT_TRUE(consensus);
  EXPECT_EQ(NumInliers(*consensus), 4u);
  EXPECT_GT(consensus->sigma_factor, 0.1);
}

TEST(PositionConsensusTest, TheFactorIsTheScatter) {
  Positions positions = Zigzag(60);
  double square = 0;
  for (size_t i = 0; i < positions.size(); ++i) {
    positions[i].metres += Wobble(i, 0.1);
    square += Wobble(i, 0.1).squaredNorm();
  }
  const double sigma = std::sqrt(square / (3.0 * 60));
  const auto unknown = FindPositionConsensus(positions, std::nullopt, 0);
  ASSERT_TRUE(unknown);
  EXPECT_NEAR(unknown->sigma_factor, sigma, 0.1 * sigma);  // metres
  for (PositionMeasurement& position : positions) position.sigma.setConstant(0.02);
  const auto known = FindPositionConsensus(positions, std::nullopt, 0);
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->sigma_factor, sigma / 0.02, 0.1 * sigma / 0.02);  // sigmas
}

TEST(PositionConsensusTest, ALineNeedsADirectionThatLevelsIt) {
  const Positions line = Line(10, {0.5, 0.2, 0.05});
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  const auto consensus = FindPositionConsensus(line, down, 0);
  ExpectTruth(consensus, 1e-9);
  EXPECT_EQ(NumInliers(*consensus), 10u);
  // The cameras look along the line, or it goes straight down.
  EXPECT_FALSE(
      FindPositionConsensus(line, Eigen::Vector3d(line[9].in_model - line[0].in_model), 0));
  EXPECT_FALSE(FindPositionConsensus(Line(10, {0, 0, -1}), down, 0));
}

TEST(PositionConsensusTest, OutliersOfALine) {
  Positions line = Line(12, {0.5, 0.2, 0.05});
  line[2].metres += Eigen::Vector3d(0, 4, 0);
  line[7].metres += Eigen::Vector3d(-3, 0, 1);
  const auto consensus = FindPositionConsensus(line, -Eigen::Vector3d::UnitZ().eval(), 0);
  ExpectTruth(consensus, 1e-9);
  for (size_t i = 0; i < line.size(); ++i) EXPECT_EQ(consensus->is_inlier[i], i != 2 && i != 7);
}

TEST(PositionConsensusTest, TooFewOrAllInOnePlace) {
  EXPECT_FALSE(FindPositionConsensus({}, std::nullopt, 0));
  EXPECT_FALSE(FindPositionConsensus(Zigzag(2), std::nullopt, 0));
  EXPECT_FALSE(FindPositionConsensus(Line(6, {0, 0, 0}), std::nullopt, 0));
  EXPECT_FALSE(FindPositionConsensus(Line(6, {0, 0, 0}), -Eigen::Vector3d::UnitZ().eval(), 0));
  EXPECT_TRUE(FindPositionConsensus(Line(2, {1, 0, 0}), -Eigen::Vector3d::UnitZ().eval(), 0));
}

TEST(PositionConsensusTest, TheSeedDrawsTheSamples) {
  Positions positions = Zigzag(60);
  for (size_t i = 0; i < positions.size(); ++i) positions[i].metres += Wobble(i, 0.2);
  const auto a = FindPositionConsensus(positions, std::nullopt, 1);
  const auto b = FindPositionConsensus(positions, std::nullopt, 1);
  EXPECT_EQ(a->metric_from_model.scale, b->metric_from_model.scale);
  EXPECT_EQ(a->is_inlier, b->is_inlier);
}

TEST(NormalisedResidualTest, InSigmasWhereTheyAreKnown) {
  PositionMeasurement position{InModel({1, 2, 3}), {1.3, 2.4, 3}, Eigen::Vector3d::Zero()};
  EXPECT_NEAR(NormalisedResidual(position, Truth()), 0.5, 1e-9);
  position.sigma = {0.1, 0.2, 0.3};
  EXPECT_NEAR(NormalisedResidual(position, Truth()), std::sqrt(9 + 4), 1e-9);
}

TEST(LevelledSimilarityTest, TheTurnAboutTheLineIsTheCameras) {
  const Positions line = Line(2, {3, 1, 0.2});
  // The cameras look ahead and down, in the vertical plane of the line.
  const Eigen::Vector3d ahead = (line[1].metres - line[0].metres).normalized();
  const Eigen::Vector3d view = (ahead - 2 * Eigen::Vector3d::UnitZ()).normalized();
  const auto similarity = LevelledSimilarity(line[0], line[1], Truth().rotation.conjugate() * view);
  ASSERT_TRUE(similarity);
  EXPECT_NEAR(similarity->scale, Truth().scale, 1e-9);
  EXPECT_LT(similarity->rotation.angularDistance(Truth().rotation), 1e-9);
  for (const PositionMeasurement& end : line) {
    EXPECT_LT((*similarity * end.in_model - end.metres).norm(), 1e-9);
  }
  // Cameras that look 10 degrees to the side are taken as looking down: the frame turns by as much.
  const Eigen::Vector3d aside =
      Eigen::AngleAxisd(10 * kPi / 180, ahead) * -Eigen::Vector3d::UnitZ();
  const auto turned = LevelledSimilarity(line[0], line[1], Truth().rotation.conjugate() * aside);
  ASSERT_TRUE(turned);
  EXPECT_NEAR(turned->rotation.angularDistance(Truth().rotation), 10 * kPi / 180, 2e-3);
}

TEST(LevelledSimilarityTest, WhatHasNone) {
  const Positions line = Line(2, {3, 1, 0});
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  EXPECT_FALSE(LevelledSimilarity(line[0], line[0], down));
  EXPECT_FALSE(LevelledSimilarity(line[0], line[1], line[1].in_model - line[0].in_model));
  const Positions dive = Line(2, {0, 0.1, -3});
  EXPECT_FALSE(LevelledSimilarity(dive[0], dive[1], down));
}

}  // namespace
}  // namespace colmap_seapoint
