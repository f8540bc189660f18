// The first half of a linear problem: every observation's residual and derivatives, and every
// point's own equations, by which the points are eliminated (Schur complement). Triggs et al.,
// "Bundle adjustment: a modern synthesis", sections 6 and 7.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "colmap_seapoint/adjustment/equations/bundle.h"
#include "colmap_seapoint/adjustment/equations/robust_loss.h"

namespace colmap_seapoint {

// One observation, all weighted by the root of its robust weight over the loss's scale. A pose
// moves by (turn, shift) in the camera's frame: y becomes exp(turn) y + shift.
struct ObservationEquations {
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> by_pose = Eigen::Matrix<double, 2, 6>::Zero();
  Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
  // By the free values of its lens, BundleLens::num_free columns.
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMaxLensParams> by_lens;
  double cost = 0;  // what RobustLoss::Cost says
};

// An observation that has come behind its camera costs as much as one of 1000 pixels, and pulls
// nothing.
ObservationEquations EquationsOf(const Bundle& bundle, const BundleValues& values,
                                 const RobustLoss& loss, size_t observation);

// What of the above is kept, 104 bytes an observation. The normal equations of the rounded
// derivatives are formed with double precision: they are exactly those of a problem that differs
// by a ten-millionth, and as positive as any.
struct ObservationRow {
  Eigen::Matrix<float, 2, 6> by_pose;
  Eigen::Vector2f residual;
  // The observation's part of an orthonormal basis of what the point can explain of its
  // observations' residuals: by_point * PointFrame. With normal equations and their inverse
  // instead, a point of little parallax would leave rounding behind that is stronger than the bend
  // of a long survey.
  Eigen::Matrix<double, 2, 3> basis;
};

struct Linearization {
  std::vector<ObservationRow> rows;
  // Of each point: what makes an orthonormal basis of its derivatives (upper triangle; zero: the
  // point is held), and the residuals' coordinates in that basis.
  std::vector<Eigen::Matrix3d> point_frames;
  std::vector<Eigen::Vector3d> point_residuals;
  std::vector<double> point_costs;
  // Of each share (Bundle::share_lens): the sum over the point's observations through that lens of
  // basis^T by_lens, 3 x num_free, columns one after another.
  std::vector<size_t> share_place;  // in lens_shares
  std::vector<double> lens_shares;
  double cost = 0;            // half the sum of RobustLoss::Cost
  double point_decrease = 0;  // of it, when the points alone are moved

  auto Share(const Bundle& bundle, size_t share) const {
    return Eigen::Map<const Eigen::Matrix3Xd>(&lens_shares[share_place[share]], 3,
                                              bundle.lenses[bundle.share_lens[share]].num_free);
  }
  auto Share(const Bundle& bundle, size_t share) {
    return Eigen::Map<Eigen::Matrix3Xd>(&lens_shares[share_place[share]], 3,
                                        bundle.lenses[bundle.share_lens[share]].num_free);
  }
};

// The places of the shares and room for everything; Linearize() may be called with it again and
// again.
Linearization MakeLinearization(const Bundle& bundle);

// Fixed blocks of points, each by one thread, sums added in their order: the same bytes for any
// number of threads. About a microsecond an observation.
void Linearize(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
               int num_threads, Linearization* linearization);

// Where a point is, and half the cost of its observations.
struct PlacedPoint {
  Eigen::Vector3d xyz;
  double cost;
};

PlacedPoint PlacePoint(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
                       size_t point, const Eigen::Vector3d& xyz);
// Moves a point alone, poses and lenses being held, by so many steps, each taken only if it makes
// the cost less.
PlacedPoint RefinePoint(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
                        size_t point, int num_steps, PlacedPoint placed);

// Calls add(begin, end) -> sum for fixed blocks of points and returns the sum of all, added in
// their order.
double SumOverPoints(const Bundle& bundle, int num_threads,
                     const std::function<double(size_t, size_t)>& add);

}  // namespace colmap_seapoint
