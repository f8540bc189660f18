// Exact worlds with a known similarity, then noise, outliers and everything that can be degenerate.
#include "colmap_seapoint/georeference/estimate_similarity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;

// metric_from_model of every test: far from the identity in all 7 unknowns.
Similarity3d Truth() {
  Similarity3d truth;
  truth.scale = 3.7;
  truth.rotation = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
  truth.translation = {512, -40, -12.5};
  return truth;
}

Eigen::Vector3d InModel(const Eigen::Vector3d& metres) {
  const Similarity3d truth = Truth();
  return truth.rotation.conjugate() * (metres - truth.translation) / truth.scale;
}

// Two strips of a lawn-mower survey at 2 m above the ground: x, y, z in metres.
std::vector<Eigen::Vector3d> Strips(int num_strips, int per_strip) {
  std::vector<Eigen::Vector3d> centres;
  for (int s = 0; s < num_strips; ++s) {
    for (int i = 0; i < per_strip; ++i) {
      const double wobble = num_strips > 1 ? 0.05 * std::sin(3.0 * i + s) : 0;
      centres.emplace_back(500 + 0.6 * i, -50 + 1.2 * s + wobble, -10 + wobble);
    }
  }
  return centres;
}

SimilarityProblem ProblemOf(const std::vector<Eigen::Vector3d>& metres) {
  SimilarityProblem problem;
  for (const Eigen::Vector3d& position : metres) {
    problem.positions.push_back({InModel(position), position, Eigen::Vector3d::Zero()});
  }
  problem.down_in_model = Truth().rotation.conjugate() * -Eigen::Vector3d::UnitZ();
  return problem;
}

LengthMeasurement Bar(double metres, double sigma = 0.001) {
  return {metres / Truth().scale, 0, metres, sigma};
}

double AngleDeg(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b) * 180 / kPi;
}

void ExpectTruth(const SimilarityEstimate& estimate, double tolerance) {
  ASSERT_EQ(estimate.problem, "");
  const Similarity3d truth = Truth();
  EXPECT_NEAR(estimate.metric_from_model.scale / truth.scale, 1, tolerance);
  EXPECT_LT(estimate.metric_from_model.rotation.angularDistance(truth.rotation), tolerance);
  // Where the measurements are, not at the far origin.
  const Eigen::Vector3d place(503, -49, -10);
  EXPECT_LT((estimate.metric_from_model * InModel(place) - place).norm(), 10 * tolerance);
}

void AddNoise(double sigma, int seed, SimilarityProblem* problem) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal(0, sigma);
  for (auto& position : problem->positions) {
    position.metres += Eigen::Vector3d(normal(random), normal(random), normal(random));
  }
}

TEST(EstimateSimilarity, ExactPositions) {
  ExpectTruth(EstimateSimilarity(ProblemOf(Strips(2, 10))), 1e-9);
}

TEST(EstimateSimilarity, ThreePositionsAreEnoughAndTwoAreNot) {
  const std::vector<Eigen::Vector3d> three = {{500, -50, -10}, {506, -50, -10}, {503, -47, -9}};
  SimilarityProblem problem = ProblemOf(three);
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ExpectTruth(estimate, 1e-9);
  EXPECT_FALSE(estimate.is_levelled);
  problem.positions.pop_back();
  EXPECT_NE(EstimateSimilarity(problem).problem.find("2 pictures of the model have a position"),
            std::string::npos);
  problem.positions.clear();
  EXPECT_NE(EstimateSimilarity(problem).problem, "");
}

TEST(EstimateSimilarity, GrossOutliersAreNamedAndChangeNothing) {
  SimilarityProblem problem = ProblemOf(Strips(2, 10));
  problem.positions[3].metres += Eigen::Vector3d(5, -2, 1);
  problem.positions[11].metres += Eigen::Vector3d(-40, 0, 0);
  problem.positions[17].metres += Eigen::Vector3d(0, 0, 0.7);
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ExpectTruth(estimate, 1e-9);
  for (size_t i = 0; i < problem.positions.size(); ++i) {
    EXPECT_EQ(estimate.position_used[i], i != 3 && i != 11 && i != 17) << i;
  }
  EXPECT_NEAR(estimate.position_residuals[11].x(), 40, 1e-6);
  EXPECT_LT(estimate.position_rms, 1e-8);
}

// A third of them wrong, and all in the same way.
TEST(EstimateSimilarity, OutliersThatAgreeAmongThemselves) {
  SimilarityProblem problem = ProblemOf(Strips(2, 12));
  for (size_t i = 0; i < 8; ++i) problem.positions[3 * i].metres.x() += 3;
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ExpectTruth(estimate, 1e-9);
  EXPECT_EQ(std::count(estimate.position_used.begin(), estimate.position_used.end(), false), 8);
}

// The standard deviations must say what really happens, over many surveys.
TEST(EstimateSimilarity, NoiseAndItsStandardDeviation) {
  constexpr int kNumRuns = 60;
  constexpr double kNoise = 0.05;
  double square = 0, predicted = 0, sigma = 0;
  for (int run = 0; run < kNumRuns; ++run) {
    SimilarityProblem problem = ProblemOf(Strips(3, 10));
    AddNoise(kNoise, run, &problem);
    const SimilarityEstimate estimate = EstimateSimilarity(problem);
    ASSERT_EQ(estimate.problem, "");
    square += std::pow(estimate.metric_from_model.scale - Truth().scale, 2) / kNumRuns;
    predicted += estimate.scale_sigma * estimate.scale_sigma / kNumRuns;
    sigma += estimate.position_sigmas[0].x() / kNumRuns;
    EXPECT_LT(AngleDeg(estimate.metric_from_model.rotation, Truth().rotation), 4.0);
  }
  EXPECT_NEAR(sigma, kNoise, 0.1 * kNoise);
  EXPECT_NEAR(std::sqrt(square / predicted), 1, 0.3);  // 60 runs: +- 9 %
}

TEST(EstimateSimilarity, NoiseWithOutliersStaysWithinTheNoise) {
  for (const double noise : {0.05, 0.3}) {
    SimilarityProblem problem = ProblemOf(Strips(4, 15));
    AddNoise(noise, 7, &problem);
    for (size_t i = 0; i < 6; ++i) problem.positions[10 * i].metres += Eigen::Vector3d(8, -9, 4);
    const SimilarityEstimate estimate = EstimateSimilarity(problem);
    ASSERT_EQ(estimate.problem, "");
    for (size_t i = 0; i < 6; ++i) EXPECT_FALSE(estimate.position_used[10 * i]) << noise;
    EXPECT_GE(std::count(estimate.position_used.begin(), estimate.position_used.end(), true), 52);
    EXPECT_NEAR(estimate.position_rms, noise * std::sqrt(3), 0.25 * noise);
    double largest = 0;
    for (const Eigen::Vector3d& position : Strips(4, 15)) {
      largest =
          std::max(largest, (estimate.metric_from_model * InModel(position) - position).norm());
    }
    EXPECT_LT(largest, 1.5 * noise);
  }
}

TEST(EstimateSimilarity, OneLineIsLevelledByTheCameras) {
  SimilarityProblem problem = ProblemOf(Strips(1, 10));
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ExpectTruth(estimate, 1e-7);
  EXPECT_TRUE(estimate.is_levelled);
  // Cameras that look ahead and down are still in the vertical plane of the line.
  problem.down_in_model = Truth().rotation.conjugate() * Eigen::Vector3d(1, 0, -1).normalized();
  ExpectTruth(EstimateSimilarity(problem), 1e-7);
  // An outlier beside the line does not make it a plane.
  problem.positions[4].metres.y() += 7;
  const SimilarityEstimate with_outlier = EstimateSimilarity(problem);
  ExpectTruth(with_outlier, 1e-7);
  EXPECT_FALSE(with_outlier.position_used[4]);
}

// A strip that wobbles by centimetres, measured to decimetres: its roll is noise.
TEST(EstimateSimilarity, ANearlyStraightLineIsLevelledToo) {
  std::vector<Eigen::Vector3d> metres = Strips(1, 12);
  for (size_t i = 0; i < metres.size(); ++i) metres[i].y() += i % 2 == 0 ? 0.02 : -0.02;
  SimilarityProblem problem = ProblemOf(metres);
  AddNoise(0.1, 3, &problem);
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ASSERT_EQ(estimate.problem, "");
  EXPECT_TRUE(estimate.is_levelled);
  const Eigen::Vector3d up =
      estimate.metric_from_model.rotation * Truth().rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_GT(up.z(), std::cos(5 * kPi / 180));
  // Exact positions of the same strip say it themselves.
  EXPECT_FALSE(EstimateSimilarity(ProblemOf(metres)).is_levelled);
}

TEST(EstimateSimilarity, OneLineThatNothingLevelsIsRefused) {
  SimilarityProblem problem = ProblemOf(Strips(1, 10));
  problem.down_in_model.setZero();
  EXPECT_NE(EstimateSimilarity(problem).problem.find("the positions lie on one line"),
            std::string::npos);
  // A dive straight down, the cameras looking down: heading is free.
  std::vector<Eigen::Vector3d> metres;
  for (int i = 0; i < 8; ++i) metres.emplace_back(500, -50, -10 - i);
  EXPECT_NE(EstimateSimilarity(ProblemOf(metres)).problem.find("the positions lie on one line"),
            std::string::npos);
  // All in one place.
  metres.assign(6, Eigen::Vector3d(500, -50, -10));
  EXPECT_NE(EstimateSimilarity(ProblemOf(metres)).problem, "");
}

TEST(EstimateSimilarity, BarsAloneGiveTheScaleAndKeepTheFrame) {
  SimilarityProblem problem;
  problem.lengths = {Bar(0.5), Bar(1.2), Bar(0.8)};
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ASSERT_EQ(estimate.problem, "");
  EXPECT_FALSE(estimate.has_frame);
  EXPECT_NEAR(estimate.metric_from_model.scale, Truth().scale, 1e-9);
  EXPECT_EQ(estimate.metric_from_model.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(estimate.metric_from_model.rotation.vec(), Eigen::Vector3d::Zero());
  // 1 mm over sqrt(0.5^2 + 1.2^2 + 0.8^2) m.
  EXPECT_NEAR(estimate.scale_sigma / Truth().scale, 0.001 / std::sqrt(2.33), 1e-9);
}

TEST(EstimateSimilarity, AWrongBarAmongThree) {
  SimilarityProblem problem;
  problem.lengths = {Bar(0.5), Bar(1.2), Bar(0.8)};
  problem.lengths[1].metres = 1.02;  // digits swapped
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  EXPECT_NEAR(estimate.metric_from_model.scale, Truth().scale, 1e-9);
  EXPECT_EQ(estimate.length_used, (std::vector<bool>{true, false, true}));
  EXPECT_NEAR(estimate.length_residuals[1], 0.18, 1e-9);
}

TEST(EstimateSimilarity, TwoBarsThatContradictAreSaid) {
  SimilarityProblem problem;
  problem.lengths = {Bar(0.5), Bar(0.5)};
  problem.lengths[1].metres = 0.6;
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  EXPECT_EQ(estimate.length_used, (std::vector<bool>{true, true}));
  ASSERT_EQ(estimate.warnings.size(), 1u);
  EXPECT_NE(estimate.warnings[0].find("contradict"), std::string::npos);
  problem.lengths[1].metres = 0.5005;
  EXPECT_TRUE(EstimateSimilarity(problem).warnings.empty());
}

TEST(EstimateSimilarity, AnUncertainEndMakesABarLight) {
  SimilarityProblem problem;
  problem.lengths = {Bar(1.0), Bar(1.0)};
  problem.lengths[0].metres = 1.02;
  problem.lengths[0].in_model_sigma = 0.02 / Truth().scale;  // 20 times less certain
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  EXPECT_NEAR(estimate.metric_from_model.scale / Truth().scale, 1 + 0.02 / 401, 1e-5);
}

// Positions to 30 cm over 6 m, a bar to a millimetre: the scale is the bar's, the frame theirs.
TEST(EstimateSimilarity, ABarCarriesTheScaleOfNoisyPositions) {
  SimilarityProblem problem = ProblemOf(Strips(3, 10));
  AddNoise(0.3, 5, &problem);
  const SimilarityEstimate without = EstimateSimilarity(problem);
  problem.lengths = {Bar(1.0)};
  const SimilarityEstimate with = EstimateSimilarity(problem);
  EXPECT_TRUE(with.length_used[0]);
  EXPECT_TRUE(with.has_frame);
  EXPECT_NEAR(with.metric_from_model.scale / Truth().scale, 1, 0.002);
  EXPECT_GT(std::abs(without.metric_from_model.scale / Truth().scale - 1), 0.002);
  EXPECT_LT(with.scale_sigma, 0.2 * without.scale_sigma);
}

TEST(EstimateSimilarity, ABarInTheWrongUnitIsSaid) {
  SimilarityProblem problem = ProblemOf(Strips(2, 10));
  AddNoise(0.02, 5, &problem);
  problem.lengths = {Bar(1.0)};
  problem.lengths[0].metres = 100;  // centimetres
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  EXPECT_FALSE(estimate.length_used[0]);
  EXPECT_NEAR(estimate.metric_from_model.scale / Truth().scale, 1, 0.02);
  ASSERT_EQ(estimate.warnings.size(), 1u);
  EXPECT_NE(estimate.warnings[0].find("check their units"), std::string::npos);
}

TEST(EstimateSimilarity, GivenSigmasWeigh) {
  // Depth to a centimetre, the rest to a metre: the vertical residuals come out small.
  SimilarityProblem problem = ProblemOf(Strips(4, 15));
  std::mt19937 random(4);
  std::normal_distribution<double> normal(0, 1);
  for (auto& position : problem.positions) {
    position.sigma = {0.3, 0.3, 0.01};
    for (int i = 0; i < 3; ++i) position.metres[i] += position.sigma[i] * normal(random);
  }
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ASSERT_EQ(estimate.problem, "");
  EXPECT_TRUE(estimate.warnings.empty());
  double vertical = 0;
  for (const Eigen::Vector3d& position : Strips(4, 15)) {
    const double error = (estimate.metric_from_model * InModel(position) - position).z();
    vertical = std::max(vertical, std::abs(error));
  }
  EXPECT_LT(vertical, 0.02);
  for (auto& position : problem.positions) position.sigma = {0.03, 0.03, 0.001};
  const SimilarityEstimate too_small = EstimateSimilarity(problem);
  ASSERT_EQ(too_small.warnings.size(), 1u);
  EXPECT_NE(too_small.warnings[0].find("times their sigmas"), std::string::npos);
}

TEST(EstimateSimilarity, TwoPositionsBesideABarAreNotUsed) {
  SimilarityProblem problem = ProblemOf({{500, -50, -10}, {503, -50, -10}});
  problem.lengths = {Bar(1.0)};
  const SimilarityEstimate estimate = EstimateSimilarity(problem);
  ASSERT_EQ(estimate.problem, "");
  EXPECT_FALSE(estimate.has_frame);
  EXPECT_EQ(estimate.warnings.size(), 1u);
  EXPECT_NEAR(estimate.metric_from_model.scale, Truth().scale, 1e-9);
}

// Noise of 5 cm: with more positions the similarity is another one, within what the first ones
// knew.
TEST(EstimateSimilarity, AFormerSimilarityIsKeptWhereThePositionsAllowIt) {
  SimilarityProblem problem = ProblemOf(Strips(5, 8));
  AddNoise(0.05, 3, &problem);
  SimilarityProblem first = problem;
  first.positions.resize(32);
  const Similarity3d former = EstimateSimilarity(first).metric_from_model;
  const SimilarityEstimate anew = EstimateSimilarity(problem);
  EXPECT_NE(anew.metric_from_model.scale, former.scale);
  EXPECT_FALSE(anew.is_former);
  problem.former = former;
  const SimilarityEstimate kept = EstimateSimilarity(problem);
  EXPECT_TRUE(kept.is_former);
  EXPECT_EQ(kept.metric_from_model.scale, former.scale);
  EXPECT_EQ(kept.metric_from_model.translation, former.translation);
  const PositionMeasurement& last = problem.positions.back();
  EXPECT_EQ(kept.position_residuals.back(), former * last.in_model - last.metres);
  // More than twice what the mean of 40 positions is uncertain by, 8.7 cm / sqrt(40).
  problem.former->translation.x() += 0.06;
  const SimilarityEstimate moved = EstimateSimilarity(problem);
  EXPECT_FALSE(moved.is_former);
  EXPECT_EQ(moved.metric_from_model.scale, anew.metric_from_model.scale);
}

TEST(EstimateSimilarity, AFormerScaleIsKeptWhereTheBarsAllowIt) {
  SimilarityProblem problem;
  problem.lengths = {Bar(0.5), Bar(1.2), Bar(0.8)};
  const SimilarityEstimate anew = EstimateSimilarity(problem);
  problem.former = anew.metric_from_model;
  problem.former->scale += 0.9 * anew.scale_sigma;
  EXPECT_EQ(EstimateSimilarity(problem).metric_from_model.scale, problem.former->scale);
  problem.former->scale += 0.2 * anew.scale_sigma;
  EXPECT_EQ(EstimateSimilarity(problem).metric_from_model.scale, anew.metric_from_model.scale);
}

TEST(EstimateSimilarity, SameBytesEveryTime) {
  SimilarityProblem problem = ProblemOf(Strips(6, 20));  // too many for all samples
  AddNoise(0.2, 2, &problem);
  const SimilarityEstimate a = EstimateSimilarity(problem), b = EstimateSimilarity(problem);
  EXPECT_EQ(a.metric_from_model.scale, b.metric_from_model.scale);
  EXPECT_EQ(a.metric_from_model.translation, b.metric_from_model.translation);
  EXPECT_EQ(a.position_used, b.position_used);
}

TEST(Similarity3d, MovesPosesWithTheWorld) {
  SparseModel model;
  PosedImage image;
  image.cam_from_world.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(2, 1, -1).normalized());
  image.cam_from_world.translation = {1, 2, 3};
  model.images = {image};
  model.points3D[9].xyz = {4, -5, 6};
  const Eigen::Vector3d in_cam = image.cam_from_world * model.points3D[9].xyz;
  TransformModel(Truth(), &model);
  const Eigen::Vector3d in_new_cam = model.images[0].cam_from_world * model.points3D[9].xyz;
  EXPECT_LT((in_new_cam - Truth().scale * in_cam).norm(), 1e-9);  // the same pixel
}

}  // namespace
}  // namespace colmap_seapoint
