#include "colmap_seapoint/georeference/similarity_solver.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kDegreesPerRadian = 180 / 3.14159265358979323846;
// Standard deviation of the angle between the mean viewing direction of cameras that look down and
// the vertical plane of their track.
constexpr double kLevellingSigma = 3 / kDegreesPerRadian;
constexpr double kMinRelativeSigma = 1e-9;  // of exact measurements
constexpr double kLossWidth = 2;            // sigmas

// The unknowns: the logarithm of the scale over the start's; the rotation vector that follows the
// start's rotation (metric axes); the translation of the pivot.
using Unknowns = std::array<double, 7>;

// Where the solver starts, and about which place of the model (its pivot) it turns and scales.
struct Linearisation {
  Similarity3d start;
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
};

Similarity3d Apply(const Linearisation& at, const Unknowns& x) {
  double wxyz[4];
  ceres::AngleAxisToQuaternion(&x[1], wxyz);
  const Eigen::Quaterniond turn(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  Similarity3d result;
  result.scale = at.start.scale * std::exp(x[0]);
  result.rotation = (turn * at.start.rotation).normalized();
  const Eigen::Vector3d centre = at.start * at.pivot + Eigen::Vector3d(x[4], x[5], x[6]);
  result.translation = centre - result.scale * (result.rotation * at.pivot);
  return result;
}

struct PositionResidual {
  Eigen::Vector3d arm;     // scale * rotation * (in_model - pivot) at the start
  Eigen::Vector3d target;  // metres, from the pivot's place at the start
  Eigen::Vector3d sigma;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    const T from[3] = {T(arm.x()), T(arm.y()), T(arm.z())};
    T turned[3];
    ceres::AngleAxisRotatePoint(x + 1, from, turned);
    const T scale = ceres::exp(x[0]);
    for (int i = 0; i < 3; ++i) {
      residual[i] = (scale * turned[i] + x[4 + i] - target[i]) / sigma[i];
    }
    return true;
  }
};

struct LengthResidual {
  double at_start, metres, sigma;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    residual[0] = (ceres::exp(x[0]) * at_start - metres) / sigma;
    return true;
  }
};

// How far the mean viewing direction leaves the vertical plane of the line.
struct LevellingResidual {
  Eigen::Vector3d down;    // at the start
  Eigen::Vector3d across;  // level, across the line

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    const T from[3] = {T(down.x()), T(down.y()), T(down.z())};
    T turned[3];
    ceres::AngleAxisRotatePoint(x + 1, from, turned);
    residual[0] = (turned[0] * across.x() + turned[1] * across.y() + turned[2] * across.z()) /
                  kLevellingSigma;
    return true;
  }
};

void AddResiduals(const EstimationState& state, const Linearisation& at, bool is_robust,
                  Unknowns* x, ceres::Problem* problem) {
  const auto loss = [&](double width) -> ceres::LossFunction* {
    return is_robust ? new ceres::CauchyLoss(width) : nullptr;
  };
  const Similarity3d& start = at.start;
  const Eigen::Vector3d centre = start * at.pivot;
  const auto& positions = state.problem.positions;
  for (size_t i = 0; i < positions.size(); ++i) {
    if (!state.position_used[i]) continue;
    problem->AddResidualBlock(
        new ceres::AutoDiffCostFunction<PositionResidual, 3, 7>(new PositionResidual{
            start.scale * (start.rotation * (positions[i].in_model - at.pivot)),
            positions[i].metres - centre, PositionSigma(state, positions[i])}),
        loss(kLossWidth), x->data());
  }
  for (size_t i = 0; i < state.problem.lengths.size(); ++i) {
    if (!state.length_used[i]) continue;
    const LengthMeasurement& length = state.problem.lengths[i];
    problem->AddResidualBlock(
        new ceres::AutoDiffCostFunction<LengthResidual, 1, 7>(
            new LengthResidual{start.scale * length.in_model, length.metres,
                               state.length_factor * LengthSigma(length, start.scale)}),
        loss(kLossWidth), x->data());
  }
  if (state.across) {
    problem->AddResidualBlock(
        new ceres::AutoDiffCostFunction<LevellingResidual, 1, 7>(
            new LevellingResidual{start.rotation * state.problem.down_in_model, *state.across}),
        nullptr, x->data());
  }
}

// Standard deviations from the curvature at the solution.
void AddCovariance(ceres::Problem* problem, SimilaritySolution* solution) {
  ceres::CRSMatrix sparse;
  problem->Evaluate(ceres::Problem::EvaluateOptions(), nullptr, nullptr, nullptr, &sparse);
  Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();
  for (int row = 0; row < sparse.num_rows; ++row) {
    Eigen::Matrix<double, 7, 1> values = Eigen::Matrix<double, 7, 1>::Zero();
    for (int k = sparse.rows[static_cast<size_t>(row)];
         k < sparse.rows[static_cast<size_t>(row) + 1]; ++k) {
      values[sparse.cols[static_cast<size_t>(k)]] = sparse.values[static_cast<size_t>(k)];
    }
    normal += values * values.transpose();
  }
  // Scaled to a unit diagonal, since the unknowns are of different kinds.
  Eigen::Matrix<double, 7, 1> unit = normal.diagonal().cwiseSqrt();
  const Eigen::Matrix<double, 7, 1> inverse_unit =
      unit.unaryExpr([](double value) { return value > 0 ? 1 / value : 0.0; });
  const Eigen::Matrix<double, 7, 7> scaled =
      inverse_unit.asDiagonal() * normal * inverse_unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 7, 7>> eigen(scaled);
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
  for (int i = 0; i < 7; ++i) {
    const double value = std::max(eigen.eigenvalues()[i], 1e-14);
    covariance += eigen.eigenvectors().col(i) * eigen.eigenvectors().col(i).transpose() / value;
  }
  covariance = inverse_unit.asDiagonal() * covariance * inverse_unit.asDiagonal();
  solution->scale_sigma = solution->similarity.scale * std::sqrt(covariance(0, 0));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turns(
      Eigen::Matrix3d(covariance.block<3, 3>(1, 1)), Eigen::EigenvaluesOnly);
  solution->rotation_sigma_deg =
      kDegreesPerRadian * std::sqrt(std::max(0.0, turns.eigenvalues()[2]));
}

}  // namespace

double LengthSigma(const LengthMeasurement& length, double scale) {
  const double sigma = std::hypot(length.sigma, scale * length.in_model_sigma);
  return std::max(sigma, kMinRelativeSigma * length.metres);
}

Eigen::Vector3d PositionSigma(const EstimationState& state, const PositionMeasurement& position) {
  return state.position_factor *
         (position.sigma.minCoeff() > 0 ? position.sigma : Eigen::Vector3d::Ones().eval());
}

Eigen::Vector3d PivotOf(const EstimationState& state) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (size_t i = 0; i < state.problem.positions.size(); ++i) {
    if (!state.position_used[i]) continue;
    sum += state.problem.positions[i].in_model;
    ++count;
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : sum;
}

SimilaritySolution SolveSimilarity(const EstimationState& state, const Similarity3d& start,
                                   bool is_robust) {
  const Linearisation at{start, PivotOf(state)};
  Unknowns x{};
  ceres::Problem problem;
  AddResiduals(state, at, is_robust, &x, &problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 0;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-15;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  SimilaritySolution solution;
  solution.similarity = Apply(at, x);
  solution.cost = summary.final_cost;
  if (!is_robust) AddCovariance(&problem, &solution);
  return solution;
}

}  // namespace colmap_seapoint
