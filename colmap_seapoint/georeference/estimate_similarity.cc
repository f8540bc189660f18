#include "colmap_seapoint/georeference/estimate_similarity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/georeference/position_consensus.h"
#include "colmap_seapoint/georeference/similarity_solver.h"

namespace colmap_seapoint {
namespace {

using State = EstimationState;
using Solution = SimilaritySolution;

constexpr size_t kMinPositions = 3;
constexpr size_t kMinPositionsForOutliers = 5;
constexpr size_t kMinLengthsForOutliers = 3;
constexpr double kMaxLengthResidual = 3.3;
// A turn less certain than this comes from levelling.
constexpr double kMaxTurnSigmaDeg = 3;
constexpr double kMinLevellingSine = 0.2;
constexpr int kMaxRounds = 10;
constexpr double kMostMoved = 2;  // times what the positions' mean is uncertain by
// Positions that stay within this share of their extent of a line say nothing of the turn about it.
constexpr double kLine = 1e-3;

// Of the scales that the lengths give one by one, the one that suits all of them best.
double ConsensusScale(const std::vector<LengthMeasurement>& lengths) {
  double best = 0, best_cost = std::numeric_limits<double>::infinity();
  for (const LengthMeasurement& candidate : lengths) {
    const double scale = candidate.metres / candidate.in_model;
    double cost = 0;
    for (const LengthMeasurement& other : lengths) {
      cost += std::min(std::abs(scale * other.in_model - other.metres) / LengthSigma(other, scale),
                       1e6);
    }
    if (cost < best_cost) {
      best_cost = cost;
      best = scale;
    }
  }
  return best;
}

// Which measurements agree with the similarity; all count where they are too few to tell.
void Choose(const Similarity3d& similarity, State* state) {
  const auto& positions = state->problem.positions;
  for (size_t i = 0; i < positions.size() && state->has_positions; ++i) {
    const double residual = NormalisedResidual(positions[i], similarity) / state->position_factor;
    state->position_used[i] =
        positions.size() < kMinPositionsForOutliers || residual <= kMaxPositionResidual;
  }
  const auto& lengths = state->problem.lengths;
  for (size_t i = 0; i < lengths.size(); ++i) {
    const double residual = std::abs(similarity.scale * lengths[i].in_model - lengths[i].metres);
    const double sigma = state->length_factor * LengthSigma(lengths[i], similarity.scale);
    state->length_used[i] = (lengths.size() < kMinLengthsForOutliers && !state->has_positions) ||
                            residual <= kMaxLengthResidual * sigma;
  }
}

size_t Count(const std::vector<bool>& used) {
  return static_cast<size_t>(std::count(used.begin(), used.end(), true));
}

// By how much the lengths' own scatter shows their sigmas to be too small; 1 where it does not.
double LengthFactor(const std::vector<LengthMeasurement>& lengths, double scale) {
  if (lengths.size() < kMinLengthsForOutliers) return 1;
  std::vector<double> residuals;
  for (const LengthMeasurement& length : lengths) {
    residuals.push_back(std::abs(scale * length.in_model - length.metres) /
                        LengthSigma(length, scale));
  }
  return std::max(1.0, 1.4826 * UpperMedian(residuals));
}

// For lengths alone: the scale is their weighted mean, with the outliers chosen anew each time.
Solution SolveScale(State* state) {
  const auto& lengths = state->problem.lengths;
  Solution solution;
  solution.similarity.scale = ConsensusScale(lengths);
  state->length_factor = LengthFactor(lengths, solution.similarity.scale);
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<bool> before = state->length_used;
    Choose(solution.similarity, state);
    if (round > 0 && state->length_used == before) break;
    double weights = 0, products = 0;
    for (size_t i = 0; i < lengths.size(); ++i) {
      if (!state->length_used[i]) continue;
      const double sigma =
          state->length_factor * LengthSigma(lengths[i], solution.similarity.scale);
      weights += lengths[i].in_model * lengths[i].in_model / (sigma * sigma);
      products += lengths[i].in_model * lengths[i].metres / (sigma * sigma);
    }
    if (!(weights > 0)) break;
    solution.similarity.scale = products / weights;
    solution.scale_sigma = 1 / std::sqrt(weights);
  }
  return solution;
}

// The start with another scale; the middle of the positions stays where it is.
Similarity3d WithScale(const State& state, const Similarity3d& start, double scale) {
  const Eigen::Vector3d pivot = PivotOf(state);
  Similarity3d result = start;
  result.scale = scale;
  result.translation = start * pivot - scale * (start.rotation * pivot);
  return result;
}

// All measurements at once, from the better of two starts.
Solution SolveAll(const PositionConsensus& consensus, State* state) {
  state->position_used = consensus.is_inlier;
  std::vector<Similarity3d> starts = {consensus.metric_from_model};
  if (!state->problem.lengths.empty()) {
    const double scale = ConsensusScale(state->problem.lengths);
    state->length_factor = LengthFactor(state->problem.lengths, scale);
    starts.push_back(WithScale(*state, starts[0], scale));
  }
  Solution best;
  for (const Similarity3d& start : starts) {
    const Solution solution = SolveSimilarity(*state, start, true);
    if (solution.cost < best.cost) best = solution;
  }
  for (int round = 0; round < kMaxRounds; ++round) {
    const auto positions = state->position_used;
    const auto lengths = state->length_used;
    Choose(best.similarity, state);
    if (Count(state->position_used) < kMinPositions) break;
    best = SolveSimilarity(*state, best.similarity, false);
    if (round > 0 && positions == state->position_used && lengths == state->length_used) break;
  }
  return best;
}

// Second over first extent of the camera centres: 0 where they lie on a line.
double Slenderness(const std::vector<PositionMeasurement>& positions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& position : positions) {
    mean += position.in_model / static_cast<double>(positions.size());
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& position : positions) {
    scatter += (position.in_model - mean) * (position.in_model - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter, Eigen::EigenvaluesOnly);
  if (!(eigen.eigenvalues()[2] > 0)) return 0;
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[1]) / eigen.eigenvalues()[2]);
}

// The level direction across the line from the positions' middle to the farthest one; nullopt when
// the line is steep or the cameras look along it.
std::optional<Eigen::Vector3d> AcrossLine(const SimilarityProblem& problem,
                                          const Similarity3d& similarity) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& position : problem.positions) {
    mean += position.in_model / static_cast<double>(problem.positions.size());
  }
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const auto& position : problem.positions) {
    const Eigen::Vector3d arm = position.in_model - mean;
    if (arm.norm() > farthest.norm()) farthest = arm;
  }
  const Eigen::Vector3d along = (similarity.rotation * farthest).normalized();
  const Eigen::Vector3d across = along.cross(Eigen::Vector3d::UnitZ());
  const double looks_along = problem.down_in_model.cross(farthest.normalized()).norm();
  if (across.norm() < kMinLevellingSine || looks_along < kMinLevellingSine) return std::nullopt;
  return across.normalized();
}

// For positions that say too little of the turn about their line: the cameras level it.
// `known_factor`: of the sigmas; 0: the scatter tells.
std::optional<Solution> SolveLevelled(State* state, double known_factor) {
  const SimilarityProblem& problem = state->problem;
  if (problem.down_in_model.norm() == 0) return std::nullopt;
  const auto consensus =
      FindPositionConsensus(problem.positions, problem.down_in_model, problem.seed);
  if (!consensus) return std::nullopt;
  state->across = AcrossLine(problem, consensus->metric_from_model);
  if (!state->across) return std::nullopt;
  state->position_factor = known_factor > 0 ? known_factor : consensus->sigma_factor;
  return SolveAll(*consensus, state);
}

bool HasSigmas(const SimilarityProblem& problem) {
  return problem.positions.front().sigma.minCoeff() > 0;
}

// From positions, and lengths if there are any. Sets estimate->problem when they do not suffice.
Solution SolveWithPositions(State* state, SimilarityEstimate* estimate) {
  const SimilarityProblem& problem = state->problem;
  const double slenderness = Slenderness(problem.positions);
  const auto consensus = FindPositionConsensus(problem.positions, std::nullopt, problem.seed);
  std::optional<Solution> solution;
  if (consensus && slenderness > kLine) {
    state->position_factor =
        HasSigmas(problem) ? std::max(1.0, consensus->sigma_factor) : consensus->sigma_factor;
    solution = SolveAll(*consensus, state);
  }
  if (!solution || solution->rotation_sigma_deg > kMaxTurnSigmaDeg) {
    State levelled = {problem, {}, 1, state->length_factor, {}, state->length_used, true};
    levelled.position_used.assign(problem.positions.size(), true);
    const bool keeps_factor = solution.has_value();
    if (const auto better = SolveLevelled(&levelled, keeps_factor ? state->position_factor : 0)) {
      solution = better;
      estimate->is_levelled = true;
      state->across = levelled.across;
      state->position_factor = levelled.position_factor;
      state->length_factor = levelled.length_factor;
      state->position_used = levelled.position_used;
      state->length_used = levelled.length_used;
    }
  }
  if (!solution) {
    estimate->problem =
        "the positions lie on one line (or in one place), the turn about it is free, and the "
        "cameras' mean viewing direction cannot level it";
    return {};
  }
  if (Count(state->position_used) < kMinPositions) {
    estimate->problem = "no three positions agree with the model";
    return {};
  }
  return *solution;
}

double UsedPositionRms(const State& state, const Similarity3d& similarity) {
  double square = 0, count = 0;
  for (size_t i = 0; i < state.problem.positions.size(); ++i) {
    if (!state.position_used[i]) continue;
    const PositionMeasurement& position = state.problem.positions[i];
    square += (similarity * position.in_model - position.metres).squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(square / count) : 0;
}

bool AllowsFormer(const State& state, const Solution& solution) {
  if (!state.problem.former) return false;
  const Similarity3d &is = solution.similarity, &was = *state.problem.former;
  if (!state.has_positions && !state.problem.positions.empty()) return false;  // in another frame
  if (!state.has_positions) return std::abs(was.scale - is.scale) <= solution.scale_sigma;
  const double allowed = kMostMoved * UsedPositionRms(state, is) /
                         std::sqrt(static_cast<double>(Count(state.position_used)));
  const auto& positions = state.problem.positions;
  return std::all_of(positions.begin(), positions.end(), [&](const PositionMeasurement& position) {
    return (was * position.in_model - is * position.in_model).norm() <= allowed;
  });
}

void FillResiduals(const State& state, SimilarityEstimate* estimate) {
  const Similarity3d& similarity = estimate->metric_from_model;
  for (size_t i = 0; i < state.problem.positions.size(); ++i) {
    const PositionMeasurement& position = state.problem.positions[i];
    const bool used = state.has_positions && state.position_used[i];
    const Eigen::Vector3d residual = similarity * position.in_model - position.metres;
    estimate->position_residuals.push_back(residual);
    estimate->position_used.push_back(used);
    estimate->position_sigmas.push_back(PositionSigma(state, position));
  }
  estimate->position_rms = UsedPositionRms(state, similarity);
  double square = 0, count = 0;
  for (size_t i = 0; i < state.problem.lengths.size(); ++i) {
    const LengthMeasurement& length = state.problem.lengths[i];
    const double residual = similarity.scale * length.in_model - length.metres;
    estimate->length_residuals.push_back(residual);
    estimate->length_used.push_back(state.length_used[i]);
    estimate->length_sigmas.push_back(state.length_factor * LengthSigma(length, similarity.scale));
    if (!state.length_used[i]) continue;
    square += residual * residual;
    ++count;
  }
  estimate->length_rms = count > 0 ? std::sqrt(square / count) : 0;
}

void FillWarnings(const State& state, SimilarityEstimate* estimate) {
  const SimilarityProblem& problem = state.problem;
  const auto times = [](double factor) { return std::to_string(factor).substr(0, 4) + " times"; };
  if (state.has_positions && HasSigmas(problem) && state.position_factor > 2) {
    estimate->warnings.push_back("the positions scatter by " + times(state.position_factor) +
                                 " their sigmas: these are taken so much larger");
  }
  if (state.length_factor > 2) {
    estimate->warnings.push_back("the lengths disagree by " + times(state.length_factor) +
                                 " their sigmas: these are taken so much larger");
  }
  for (size_t i = 0; i < problem.lengths.size(); ++i) {
    if (!state.length_used[i] || std::abs(estimate->length_residuals[i]) <=
                                     kMaxLengthResidual * estimate->length_sigmas[i]) {
      continue;
    }
    estimate->warnings.push_back(
        "two lengths contradict each other, and nothing says which is wrong: both are used");
    break;
  }
  if (state.has_positions && !problem.lengths.empty() && Count(state.length_used) == 0) {
    estimate->warnings.push_back(
        "every length contradicts the positions and is taken as an outlier: check their units");
  }
}

}  // namespace

SimilarityEstimate EstimateSimilarity(const SimilarityProblem& problem) {
  SimilarityEstimate estimate;
  State state = {problem, {}, 1, 1, {}, {}, problem.positions.size() >= kMinPositions};
  state.position_used.assign(problem.positions.size(), state.has_positions);
  state.length_used.assign(problem.lengths.size(), true);
  if (!state.has_positions && problem.lengths.empty()) {
    estimate.problem = std::to_string(problem.positions.size()) +
                       " pictures of the model have a position; 3 are needed at least";
    return estimate;
  }
  if (!state.has_positions && !problem.positions.empty()) {
    estimate.warnings.push_back("only " + std::to_string(problem.positions.size()) +
                                " pictures of the model have a position: the frame stays the "
                                "model's own");
  }
  const Solution solution =
      state.has_positions ? SolveWithPositions(&state, &estimate) : SolveScale(&state);
  if (!estimate.problem.empty()) return estimate;
  estimate.is_former = AllowsFormer(state, solution);
  estimate.metric_from_model = estimate.is_former ? *problem.former : solution.similarity;
  estimate.scale_sigma = solution.scale_sigma;
  estimate.rotation_sigma_deg = solution.rotation_sigma_deg;
  estimate.has_frame = state.has_positions;
  FillResiduals(state, &estimate);
  FillWarnings(state, &estimate);
  return estimate;
}

}  // namespace colmap_seapoint
