#include "colmap_seapoint/georeference/similarity_solver.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

Similarity3d Truth() {
  Similarity3d truth;
  truth.scale = 0.4;
  truth.rotation = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, 1, -2).normalized());
  truth.translation = {-8, 300, 12};
  return truth;
}

PositionMeasurement Exact(const Eigen::Vector3d& in_model) {
  return {in_model, Truth() * in_model, Eigen::Vector3d::Zero()};
}

class SolverTest : public testing::Test {
 protected:
  SolverTest() {
    for (int i = 0; i < 8; ++i) {
      problem_.positions.push_back(Exact({10.0 + i, 5.0 + (i * i) % 7, 0.5 * (i % 3)}));
    }
    problem_.down_in_model = Truth().rotation.conjugate() * -Eigen::Vector3d::UnitZ();
  }

  EstimationState State() const {
    EstimationState state{problem_, {}, 1, 1, {}, {}, !problem_.positions.empty()};
    state.position_used.assign(problem_.positions.size(), true);
    state.length_used.assign(problem_.lengths.size(), true);
    return state;
  }

  // Off by a quarter in scale, by 20 degrees and by some metres.
  static Similarity3d Start() {
    Similarity3d start = Truth();
    start.scale *= 1.25;
    start.rotation =
        start.rotation * Eigen::AngleAxisd(0.35, Eigen::Vector3d(1, 1, 0).normalized());
    start.translation += Eigen::Vector3d(2, -3, 1);
    return start;
  }

  static void ExpectTruth(const SimilaritySolution& solution, double tolerance) {
    EXPECT_NEAR(solution.similarity.scale, Truth().scale, tolerance);
    EXPECT_LT(solution.similarity.rotation.angularDistance(Truth().rotation), tolerance);
    const Eigen::Vector3d place(13, 6, 0.4);
    EXPECT_LT((solution.similarity * place - Truth() * place).norm(), 10 * tolerance);
  }

  SimilarityProblem problem_;
};

TEST_F(SolverTest, FindsTheExactSimilarityFromAfar) {
  const SimilaritySolution solution = SolveSimilarity(State(), Start(), false);
  ExpectTruth(solution, 1e-9);
  EXPECT_LT(solution.cost, 1e-12);
}

TEST_F(SolverTest, OnlyWhatIsUsedCounts) {
  problem_.positions[2].metres += Eigen::Vector3d(50, 0, 0);
  problem_.lengths.push_back({10, 0, 99, 0.001});
  EstimationState state = State();
  state.position_used[2] = false;
  state.length_used[0] = false;
  ExpectTruth(SolveSimilarity(state, Start(), false), 1e-9);
  state.position_used[2] = true;
  EXPECT_GT(SolveSimilarity(state, Start(), false).cost, 1);
}

TEST_F(SolverTest, TheRobustLossHardlyMindsAnOutlier) {
  problem_.positions[2].metres += Eigen::Vector3d(50, 0, 0);
  EstimationState state = State();
  state.position_factor = 0.01;
  const SimilaritySolution robust = SolveSimilarity(state, Truth(), true);
  const SimilaritySolution plain = SolveSimilarity(state, Truth(), false);
  EXPECT_NEAR(robust.similarity.scale, Truth().scale, 1e-3);
  EXPECT_GT(std::abs(plain.similarity.scale - Truth().scale), 0.1);
  // Standard deviations are those of the last, plain solution alone.
  EXPECT_EQ(robust.scale_sigma, 0);
  EXPECT_GT(plain.scale_sigma, 0);
}

TEST_F(SolverTest, ALengthAloneHoldsTheScaleOnly) {
  problem_.positions.clear();
  problem_.lengths = {{5, 0, 2, 0.001}};
  const SimilaritySolution solution = SolveSimilarity(State(), Start(), false);
  EXPECT_NEAR(solution.similarity.scale, 0.4, 1e-9);
  // 1 mm in 2 m.
  EXPECT_NEAR(solution.scale_sigma / solution.similarity.scale, 0.001 / 2, 1e-7);
}

TEST_F(SolverTest, StandardDeviationsFollowTheSigmas) {
  EstimationState state = State();
  state.position_factor = 0.05;
  const SimilaritySolution solution = SolveSimilarity(state, Truth(), false);
  // Of the scale by the closed form: sigma over the root of the sum of squared arms.
  const Eigen::Vector3d pivot = PivotOf(state);
  double square = 0;
  for (const auto& position : problem_.positions)
    square += (position.in_model - pivot).squaredNorm();
  EXPECT_NEAR(solution.scale_sigma, 0.05 / std::sqrt(square), 1e-9);
  state.position_factor = 0.1;
  const SimilaritySolution doubled = SolveSimilarity(state, Truth(), false);
  EXPECT_NEAR(doubled.scale_sigma, 2 * solution.scale_sigma, 1e-9);
  EXPECT_NEAR(doubled.rotation_sigma_deg, 2 * solution.rotation_sigma_deg, 1e-6);
}

TEST_F(SolverTest, LevellingSettlesTheTurnAboutALine) {
  problem_.positions.clear();
  for (int i = 0; i < 6; ++i) problem_.positions.push_back(Exact({2.0 * i, 1.0 * i, 0.3 * i}));
  const Eigen::Vector3d along = Truth().rotation * Eigen::Vector3d(2, 1, 0.3).normalized();
  // A start that is turned about the line by 30 degrees.
  Similarity3d start = Truth();
  start.rotation = Eigen::AngleAxisd(0.5, along) * start.rotation;
  EstimationState state = State();
  state.position_factor = 0.01;
  const SimilaritySolution free = SolveSimilarity(state, start, false);
  EXPECT_GT(free.similarity.rotation.angularDistance(Truth().rotation), 0.4);
  state.across = along.cross(Eigen::Vector3d::UnitZ()).normalized();
  const SimilaritySolution level = SolveSimilarity(state, start, false);
  EXPECT_LT(level.similarity.rotation.angularDistance(Truth().rotation), 1e-6);
  EXPECT_LT(level.rotation_sigma_deg, 20);
  EXPECT_GT(level.rotation_sigma_deg, 3);  // the levelling's own 3 degrees, at an angle to the line
}

TEST(LengthSigmaTest, OfLengthAndModelNeverZero) {
  EXPECT_NEAR(LengthSigma({2, 0, 1, 0.003}, 0.5), 0.003, 1e-12);
  EXPECT_NEAR(LengthSigma({2, 0.008, 1, 0.003}, 0.5), 0.005, 1e-12);
  EXPECT_NEAR(LengthSigma({2, 0, 4, 0}, 0.5), 4e-9, 1e-15);
}

TEST_F(SolverTest, PositionSigmasAreTheGivenOnesTimesTheFactor) {
  EstimationState state = State();
  state.position_factor = 3;
  EXPECT_EQ(PositionSigma(state, problem_.positions[0]), Eigen::Vector3d(3, 3, 3));
  PositionMeasurement known = problem_.positions[0];
  known.sigma = {0.1, 0.2, 0.5};
  EXPECT_LT((PositionSigma(state, known) - Eigen::Vector3d(0.3, 0.6, 1.5)).norm(), 1e-12);
}

TEST_F(SolverTest, ThePivotIsTheMiddleOfWhatIsUsed) {
  EstimationState state = State();
  state.position_used.assign(problem_.positions.size(), false);
  EXPECT_EQ(PivotOf(state), Eigen::Vector3d::Zero());
  state.position_used[0] = state.position_used[3] = true;
  EXPECT_LT(
      (PivotOf(state) - 0.5 * (problem_.positions[0].in_model + problem_.positions[3].in_model))
          .norm(),
      1e-12);
}

}  // namespace
}  // namespace colmap_seapoint
