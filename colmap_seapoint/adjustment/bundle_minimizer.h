// Levenberg-Marquardt on a bundle: the values at which the robust sum of the errors is least.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "colmap_seapoint/adjustment/reduced_system.h"

namespace colmap_seapoint {

struct Minimum {
  double cost = 0;         // half the sum of RobustLoss::Cost
  int num_iterations = 0;  // steps tried
  bool is_converged = false;
};

// How uncertain a linear function of an adjustment's values is, and how that goes with the lenses'
// parameters.
struct LinearSpread {
  double sigma = 0;
  std::vector<LensParams> correlations;  // by lens, -1 to 1; 0 for what is held
};

class BundleMinimizer {
 public:
  BundleMinimizer(const Bundle& bundle, int num_threads);

  // From `values` on, at most so many steps; on_step(number) is called before each.
  //
  // It has converged when the step that is left would not move any combination of poses and lenses
  // by more than a hundredth of its standard deviation (were the noise as large as the loss's
  // scale). A bound on how much the cost falls would end too early: where focal length, distortion
  // and the bend of the ground trade places, the cost hardly changes over many pixels.
  Minimum Run(const RobustLoss& loss, int max_num_iterations,
              const std::function<void(int)>& on_step, BundleValues* values);

  // After Run: the standard deviation of each parameter of a lens, all others being free, were the
  // errors of one coordinate `sigma` pixels; 0 for what is held.
  LensParams LensSigmas(size_t lens, double sigma) const;
  // The same of a sum over the pictures' centres, each times a vector of its own, at `values`;
  // without what the sum has of a shift, turn or scale of the whole.
  LinearSpread SpreadOfCentres(const std::vector<Eigen::Vector3d>& weights,
                               const BundleValues& values, double sigma) const;

 private:
  struct Trial {
    BundleValues values;
    double cost;
  };

  bool SolveDamped();
  PlacedPoint MovePoint(const RobustLoss& loss, const BundleValues& before,
                        const BundleValues& after, size_t point) const;
  Trial Try(const RobustLoss& loss, const BundleValues& values) const;
  double PredictedDecrease() const;
  double PriorCost(const BundleValues& values) const;
  void LinearizeAt(const RobustLoss& loss, const BundleValues& values);

  const Bundle& bundle_;
  const int num_threads_;
  Linearization linearization_;
  ReducedSystem system_;
  BlockCholesky cholesky_;
  double damping_ = 0;
  Eigen::VectorXd step_;
  double loss_scale_ = 1;
};

}  // namespace colmap_seapoint
