#include "colmap_seapoint/adjustment/bundle_minimizer.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

// Relative to the equations' diagonal.
constexpr double kFirstDamping = 1e-4;
// It is what holds the model's frame. The bend of a thousand pictures is weaker than 1e-8 of the
// diagonal; the factors' rounding is some 1e-14.
constexpr double kMinDamping = 1e-12;
constexpr double kMaxDamping = 1e8;
// Below it the damping does not hide what step is left.
constexpr double kDampingOfConvergence = 1e-10;
constexpr double kMaxStepInSigmas = 1e-3;
static const int kPointSteps = getenv("PS") ? atoi(getenv("PS")) : 1;
constexpr double kRounding = 1e-13;  // of the cost, relative

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
  double growth = 2;
  Minimum minimum;
  LinearizeAt(loss, *values);
  while (minimum.num_iterations < max_num_iterations && damping_ < kMaxDamping) {
    on_step(minimum.num_iterations++);
    minimum.cost = linearization_.cost + PriorCost(*values);
    if (!SolveDamped()) {
      damping_ *= 10;
      continue;
    }
    const double decrement = -step_.dot(system_.gradient);
    Trial trial = Try(loss, *values);
    const double predicted = PredictedDecrease();
    const double gain = minimum.cost - trial.cost;
    const bool is_better = gain > 0;
    if (getenv("BA_LOG")) fprintf(stderr, "%d cost %.10g trial %.10g pred %.4g pt %.4g dec %.4g damp %.3g\n", minimum.num_iterations, minimum.cost, trial.cost, predicted, linearization_.point_decrease, decrement, damping_);
    if (is_better) *values = std::move(trial.values);
    minimum.is_converged =
        damping_ <= kDampingOfConvergence &&
        (decrement <= kMaxStepInSigmas * kMaxStepInSigmas || predicted < kRounding * minimum.cost);
    if (minimum.is_converged) {
      if (is_better) minimum.cost = trial.cost;
      break;
    }
    if (is_better) {
      const double ratio = 2 * gain / predicted - 1;
      damping_ = std::max(kMinDamping, damping_ * std::max(0.1, 1 - ratio * ratio * ratio));
      growth = 2;
      LinearizeAt(loss, *values);
    } else {
      damping_ *= growth;
      growth *= 2;
    }
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

// A point keeps its place where the step of the linear problem would only make it worse: one that
// has hardly any parallax would else spoil the step of all.
BundleMinimizer::Trial BundleMinimizer::Try(const RobustLoss& loss,
                                            const BundleValues& values) const {
  Trial trial = {MovePosesAndLenses(bundle_, system_, step_, values), 0};
  trial.cost = PriorCost(trial.values) +
               SumOverPoints(bundle_, num_threads_, [&](size_t begin, size_t end) {
                 double sum = 0;
                 for (size_t p = begin; p < end; ++p) {
                   const Eigen::Vector3d moved =
                       values.points[p] + PointStep(bundle_, linearization_, system_, step_, p);
                   PlacedPoint best = PlacePoint(bundle_, trial.values, loss, p, moved);
                   if (best.cost > linearization_.point_costs[p]) {
                     const PlacedPoint there =
                         PlacePoint(bundle_, trial.values, loss, p, values.points[p]);
                     if (there.cost < best.cost) best = there;
                   }
                   best = RefinePoint(bundle_, trial.values, loss, p, kPointSteps, best);
                   trial.values.points[p] = best.xyz;
                   sum += best.cost;
                 }
                 return sum;
               });
  return trial;
}

double BundleMinimizer::PredictedDecrease() const {
  const double of_step = step_.dot(damping_ * system_.diagonal.cwiseProduct(step_)) -
                         step_.dot(system_.gradient);
  return linearization_.point_decrease + 0.5 * of_step;
}

double BundleMinimizer::PriorCost(const BundleValues& values) const {
  double cost = 0;
  for (size_t c = 0; c < bundle_.lenses.size(); ++c) {
    const BundleLens& lens = bundle_.lenses[c];
    for (int axis = 0; axis < 2; ++axis) {
      const auto param = static_cast<size_t>(NumFocals(lens.model) + axis);
      const double off = values.lenses[c][param] - lens.principal_point[axis];
      cost += 0.5 * lens.principal_point_weight * off * off;
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

}  // namespace colmap_seapoint
