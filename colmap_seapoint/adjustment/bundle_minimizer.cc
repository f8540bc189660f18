#include "colmap_seapoint/adjustment/bundle_minimizer.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

// Relative to the equations' diagonal.
constexpr double kFirstDamping = 1e-4;
// It is what holds the model's frame. The bend of a thousand pictures is weaker than 1e-8 of the
// diagonal; the factors' rounding is some 1e-14.
constexpr double kMinDamping = 1e-11;
constexpr double kMaxDamping = 1e8;
// Below it the damping does not hide what step is left.
constexpr double kDampingOfConvergence = 1e-10;
constexpr double kMaxStepInSigmas = 0.01;
constexpr double kMaxDecrement = kMaxStepInSigmas * kMaxStepInSigmas;
// Of each point alone after a step of all. A long survey bends back only along a curve; points that
// follow the poses make the step on that curve three times as long.
constexpr int kPointSteps = 2;
constexpr double kRounding = 1e-13;  // of the cost, relative

// What of the weights no shift, turn or other scale of the whole moves: nothing holds these, so
// that the rest's uncertainty has no bounds.
std::vector<Eigen::Vector3d> WithoutFrame(const std::vector<Eigen::Vector3d>& weights,
                                          const BundleValues& values) {
  const auto n = static_cast<Eigen::Index>(weights.size());
  Eigen::Matrix3Xd centres(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const BundlePose& pose = values.poses[static_cast<size_t>(i)];
    centres.col(i) = -pose.rotation.transpose() * pose.translation;
  }
  centres.colwise() -= centres.rowwise().mean().eval();
  Eigen::MatrixXd moves(3 * n, 7);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d centre = centres.col(i);
    auto rows = moves.middleRows<3>(3 * i);
    rows.leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) {
      rows.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(centre);
    }
    rows.col(6) = centre;
  }
  const Eigen::Map<const Eigen::VectorXd> all(weights[0].data(), 3 * n);
  const Eigen::VectorXd rest = all - moves * moves.completeOrthogonalDecomposition().solve(all);
  std::vector<Eigen::Vector3d> left(weights.size());
  for (Eigen::Index i = 0; i < n; ++i) left[static_cast<size_t>(i)] = rest.segment<3>(3 * i);
  return left;
}

// After a step that gained this share of what the linear problem promised (Nielsen's rule).
double DampingFactor(double share) {
  const double surplus = 2 * share - 1;
  return std::max(0.1, 1 - surplus * surplus * surplus);
}

}  // namespace

BundleMinimizer::BundleMinimizer(const Bundle& bundle, int num_threads)
    : bundle_(bundle),
      num_threads_(num_threads),
      linearization_(MakeLinearization(bundle)),
      system_(MakeReducedSystem(bundle)),
      cholesky_(system_.matrix) {}

Minimum BundleMinimizer::Run(const RobustLoss& loss, int max_num_iterations,
                             const std::function<void(int)>& on_step, BundleValues* values) {
  loss_scale_ = loss.scale;
  damping_ = kFirstDamping;
  double growth = 2, lowest_damping = kMinDamping;
  LinearizeAt(loss, *values);
  bool was_small = false;
  Minimum minimum;
  minimum.cost = linearization_.cost + PriorCost(*values);
  while (!minimum.is_converged && minimum.num_iterations < max_num_iterations &&
         damping_ < kMaxDamping) {
    on_step(minimum.num_iterations++);
    if (!SolveDamped()) {
      lowest_damping = damping_ *= 10;
      continue;
    }
    Trial trial = Try(loss, *values);
    const double predicted = PredictedDecrease();
    const double gain = minimum.cost - trial.cost;
    const bool is_small =
        -step_.dot(system_.gradient) <= kMaxDecrement || predicted < kRounding * minimum.cost;
    minimum.is_converged =
        is_small && was_small && damping_ <= std::max(kDampingOfConvergence, lowest_damping);
    if (gain > 0) {
      *values = std::move(trial.values);
      minimum.cost = trial.cost;
      damping_ *= DampingFactor(gain / predicted);
      growth = 2;
      if (!minimum.is_converged) LinearizeAt(loss, *values);
    } else {
      damping_ *= growth;
      growth *= 2;
    }
    was_small = is_small;
    // A small step may be one that the damping hides.
    damping_ = is_small ? lowest_damping : std::max(damping_, lowest_damping);
  }
  return minimum;
}

void BundleMinimizer::LinearizeAt(const RobustLoss& loss, const BundleValues& values) {
  Linearize(bundle_, values, loss, num_threads_, &linearization_);
  Reduce(bundle_, values, loss, linearization_, num_threads_, &system_);
}

bool BundleMinimizer::SolveDamped() {
  if (!cholesky_.Factor(system_.matrix, damping_ * system_.diagonal, num_threads_)) return false;
  step_ = -cholesky_.Solve(system_.gradient);
  return step_.allFinite();
}

// By the step that belongs to that of the poses, and then alone. A point keeps its place where that
// step would only make it worse: one that has hardly any parallax would else spoil the step of all.
PlacedPoint BundleMinimizer::MovePoint(const RobustLoss& loss, const BundleValues& before,
                                       const BundleValues& after, size_t point) const {
  const Eigen::Vector3d& was = before.points[point];
  const Eigen::Vector3d step = PointStep(bundle_, linearization_, system_, step_, point);
  PlacedPoint best = PlacePoint(bundle_, after, loss, point, was + step);
  if (best.cost > linearization_.point_costs[point]) {
    const PlacedPoint there = PlacePoint(bundle_, after, loss, point, was);
    if (there.cost < best.cost) best = there;
  }
  return RefinePoint(bundle_, after, loss, point, kPointSteps, best);
}

BundleMinimizer::Trial BundleMinimizer::Try(const RobustLoss& loss,
                                            const BundleValues& values) const {
  Trial trial = {MovePosesAndLenses(bundle_, system_, step_, values), 0};
  const auto move_points = [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t p = begin; p < end; ++p) {
      const PlacedPoint best = MovePoint(loss, values, trial.values, p);
      trial.values.points[p] = best.xyz;
      sum += best.cost;
    }
    return sum;
  };
  trial.cost = PriorCost(trial.values) + SumOverPoints(bundle_, num_threads_, move_points);
  return trial;
}

double BundleMinimizer::PredictedDecrease() const {
  const double of_step =
      step_.dot(damping_ * system_.diagonal.cwiseProduct(step_)) - step_.dot(system_.gradient);
  return linearization_.point_decrease + 0.5 * of_step;
}

double BundleMinimizer::PriorCost(const BundleValues& values) const {
  double cost = 0;
  for (size_t c = 0; c < bundle_.lenses.size(); ++c) {
    const BundleLens& lens = bundle_.lenses[c];
    for (size_t k = 0; k < kMaxLensParams; ++k) {
      const double off = values.lenses[c][k] - lens.prior[k];
      cost += 0.5 * lens.prior_weights[k] * off * off;
    }
  }
  return cost;
}

LensParams BundleMinimizer::LensSigmas(size_t lens, double sigma) const {
  LensParams sigmas{};
  for (size_t k = 0; k < kMaxLensParams; ++k) {
    const int slot = bundle_.lenses[lens].slots[k];
    if (slot < 0) continue;
    const double variance = cholesky_.InverseDiagonal(system_.LensIndex(lens) + slot);
    sigmas[k] = sigma / loss_scale_ * std::sqrt(variance);
  }
  return sigmas;
}

LinearSpread BundleMinimizer::SpreadOfCentres(const std::vector<Eigen::Vector3d>& weights,
                                              const BundleValues& values, double sigma) const {
  // A pose's step by t, in the camera's frame, moves the centre by -R^T t, and a turn not at all.
  Eigen::VectorXd functional = Eigen::VectorXd::Zero(system_.gradient.size());
  const std::vector<Eigen::Vector3d> left = WithoutFrame(weights, values);
  for (size_t i = 0; i < left.size(); ++i) {
    functional.segment<3>(static_cast<Eigen::Index>(kBlockSize * i) + 3) =
        -values.poses[i].rotation * left[i];
  }
  const Eigen::VectorXd solved = cholesky_.Solve(functional);
  const double to_sigma = sigma / loss_scale_;
  LinearSpread spread;
  spread.sigma = to_sigma * std::sqrt(std::max(0.0, functional.dot(solved)));
  for (size_t c = 0; c < bundle_.lenses.size(); ++c) {
    const LensParams sigmas = LensSigmas(c, sigma);
    LensParams& correlations = spread.correlations.emplace_back();
    for (size_t k = 0; k < kMaxLensParams; ++k) {
      if (!(sigmas[k] > 0 && spread.sigma > 0)) continue;
      const double covariance =
          to_sigma * to_sigma * solved[system_.LensIndex(c) + bundle_.lenses[c].slots[k]];
      correlations[k] = covariance / (sigmas[k] * spread.sigma);
    }
  }
  return spread;
}

}  // namespace colmap_seapoint
