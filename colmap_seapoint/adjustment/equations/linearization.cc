#include "colmap_seapoint/adjustment/equations/linearization.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kPointsOfBlock = 512;
constexpr double kErrorBehindCamera = 1000;  // pixels
// Relative to the diagonal: keeps the first factors of a point with hardly any parallax real.
constexpr double kPointDamping = 1e-14;

bool IsBehind(const Eigen::Vector3d& in_cam) { return !(in_cam.z() > 0); }

double CostBehindCamera(const RobustLoss& loss) {
  return loss.Cost(kErrorBehindCamera * kErrorBehindCamera / (loss.scale * loss.scale));
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& y) {
  Eigen::Matrix3d cross;
  cross << 0, -y.z(), y.y(),  //
      y.z(), 0, -y.x(),       //
      -y.y(), y.x(), 0;
  return cross;
}

// F with F^T (normal) F = 1, upper triangular; zero where there is none.
Eigen::Matrix3d OrthonormalFrame(const Eigen::Matrix3d& normal) {
  const Eigen::LLT<Eigen::Matrix3d> factors(normal);
  if (factors.info() != Eigen::Success) return Eigen::Matrix3d::Zero();
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  factors.matrixU().solveInPlace(frame);
  if (!frame.allFinite()) return Eigen::Matrix3d::Zero();
  return frame;
}

Eigen::Matrix3d Damped(Eigen::Matrix3d normal) {
  normal.diagonal() *= 1 + kPointDamping;
  return normal;
}

// Turns the rows' derivatives by the point (in `basis`) into an orthonormal basis: twice, since the
// normal equations square what is ill-conditioned, and the second time mends that.
Eigen::Matrix3d Orthonormalize(ObservationRow* begin, ObservationRow* end) {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  for (int pass = 0; pass < 2; ++pass) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    for (const ObservationRow* row = begin; row != end; ++row) {
      normal.noalias() += row->basis.transpose() * row->basis;
    }
    const Eigen::Matrix3d further = OrthonormalFrame(pass == 0 ? Damped(normal) : normal);
    for (ObservationRow* row = begin; row != end; ++row) row->basis *= further;
    frame *= further;
  }
  return frame;
}

// Returns the squared length of the residuals' part that the point can explain.
double LinearizePoint(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
                      size_t point, Linearization* out) {
  const uint32_t first_share = bundle.share_begin[point];
  const uint32_t begin = bundle.point_begin[point], end = bundle.point_begin[point + 1];
  for (uint32_t s = first_share; s < bundle.share_begin[point + 1]; ++s) {
    out->Share(bundle, s).setZero();
  }
  std::vector<ObservationEquations> equations(end - begin);
  out->point_costs[point] = 0;
  for (uint32_t k = begin; k < end; ++k) {
    ObservationRow& row = out->rows[k];
    ObservationEquations& full = equations[k - begin];
    full = EquationsOf(bundle, values, loss, k);
    row.by_pose = full.by_pose.cast<float>();
    row.residual = full.residual.cast<float>();
    row.basis = full.by_point;
    out->point_costs[point] += 0.5 * full.cost;
  }
  out->point_frames[point] = Orthonormalize(&out->rows[begin], &out->rows[begin] + (end - begin));
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();
  for (uint32_t k = begin; k < end; ++k) {
    const ObservationRow& row = out->rows[k];
    residual.noalias() += row.basis.transpose() * row.residual.cast<double>();
    const uint32_t lens = bundle.lens_of_picture[bundle.picture_of[k]];
    uint32_t share = first_share;
    while (bundle.share_lens[share] != lens) ++share;
    out->Share(bundle, share) += row.basis.transpose().lazyProduct(equations[k - begin].by_lens);
  }
  out->point_residuals[point] = residual;
  return residual.squaredNorm();
}

}  // namespace

ObservationEquations EquationsOf(const Bundle& bundle, const BundleValues& values,
                                 const RobustLoss& loss, size_t observation) {
  const uint32_t picture = bundle.picture_of[observation];
  const uint32_t lens_idx = bundle.lens_of_picture[picture];
  const BundleLens& lens = bundle.lenses[lens_idx];
  const BundlePose& pose = values.poses[picture];
  ObservationEquations equations;
  equations.by_lens.setZero(2, lens.num_free);
  equations.cost = CostBehindCamera(loss);
  const Eigen::Vector3d in_cam = pose * values.points[bundle.point_of[observation]];
  if (IsBehind(in_cam)) return equations;
  const LensJacobian jacobian = DifferentiateLens(lens.model, values.lenses[lens_idx], in_cam);
  const Eigen::Vector2d error = jacobian.pixel - bundle.pixels[observation];
  const double s = error.squaredNorm() / (loss.scale * loss.scale);
  if (!std::isfinite(s)) return equations;

  const double weight = std::sqrt(loss.Weight(s)) / loss.scale;
  equations.cost = loss.Cost(s);
  equations.residual = weight * error;
  const Eigen::Matrix<double, 2, 3> by_point = weight * jacobian.by_point;
  if (!bundle.holds_pose[picture]) {
    equations.by_pose.leftCols<3>() = -by_point * CrossMatrix(in_cam);
    equations.by_pose.rightCols<3>() = by_point;
  }
  equations.by_point = by_point * pose.rotation;
  for (int k = 0; k < kMaxLensParams; ++k) {
    const int slot = lens.slots[static_cast<size_t>(k)];
    if (slot >= 0) equations.by_lens.col(slot) += weight * jacobian.by_params.col(k);
  }
  return equations;
}

Linearization MakeLinearization(const Bundle& bundle) {
  Linearization out;
  out.rows.resize(bundle.NumObservations());
  out.point_frames.resize(bundle.NumPoints());
  out.point_residuals.resize(bundle.NumPoints());
  out.point_costs.resize(bundle.NumPoints());
  size_t size = 0;
  for (uint32_t lens : bundle.share_lens) {
    out.share_place.push_back(size);
    size += 3 * static_cast<size_t>(bundle.lenses[lens].num_free);
  }
  out.lens_shares.resize(size + 1);  // the last share may be empty
  return out;
}

void Linearize(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
               int num_threads, Linearization* linearization) {
  linearization->point_decrease =
      0.5 * SumOverPoints(bundle, num_threads, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t p = begin; p < end; ++p) {
          sum += LinearizePoint(bundle, values, loss, p, linearization);
        }
        return sum;
      });
  const std::vector<double>& costs = linearization->point_costs;
  linearization->cost = std::accumulate(costs.begin(), costs.end(), 0.0);
}

PlacedPoint PlacePoint(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
                       size_t point, const Eigen::Vector3d& xyz) {
  double cost = 0;
  for (uint32_t k = bundle.point_begin[point]; k < bundle.point_begin[point + 1]; ++k) {
    const uint32_t picture = bundle.picture_of[k];
    const uint32_t lens = bundle.lens_of_picture[picture];
    const Eigen::Vector3d in_cam = values.poses[picture] * xyz;
    const Eigen::Vector2d pixel =
        ProjectThroughLens(bundle.lenses[lens].model, values.lenses[lens], in_cam);
    const double s = (pixel - bundle.pixels[k]).squaredNorm() / (loss.scale * loss.scale);
    cost += IsBehind(in_cam) || !std::isfinite(s) ? CostBehindCamera(loss) : loss.Cost(s);
  }
  return {xyz, 0.5 * cost};
}

PlacedPoint RefinePoint(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
                        size_t point, int num_steps, PlacedPoint placed) {
  for (int step = 0; step < num_steps; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (uint32_t k = bundle.point_begin[point]; k < bundle.point_begin[point + 1]; ++k) {
      const uint32_t picture = bundle.picture_of[k];
      const uint32_t lens = bundle.lens_of_picture[picture];
      const Eigen::Vector3d in_cam = values.poses[picture] * placed.xyz;
      if (IsBehind(in_cam)) continue;
      const LensJacobian jacobian =
          DifferentiateByPoint(bundle.lenses[lens].model, values.lenses[lens], in_cam);
      const Eigen::Vector2d error = jacobian.pixel - bundle.pixels[k];
      const double s = error.squaredNorm() / (loss.scale * loss.scale);
      if (!std::isfinite(s)) continue;
      const Eigen::Matrix<double, 2, 3> by_point =
          jacobian.by_point * values.poses[picture].rotation;
      const double weight = loss.Weight(s);
      normal.noalias() += weight * by_point.transpose() * by_point;
      gradient.noalias() += weight * by_point.transpose() * error;
    }
    const Eigen::Matrix3d frame = OrthonormalFrame(Damped(normal));
    const PlacedPoint moved = PlacePoint(bundle, values, loss, point,
                                         placed.xyz - frame * (frame.transpose() * gradient));
    if (!(moved.cost < placed.cost)) break;
    placed = moved;
  }
  return placed;
}

double SumOverPoints(const Bundle& bundle, int num_threads,
                     const std::function<double(size_t, size_t)>& add) {
  const size_t num_blocks = (bundle.NumPoints() + kPointsOfBlock - 1) / kPointsOfBlock;
  std::vector<double> sums(num_blocks);
  ParallelFor(num_threads, static_cast<int64_t>(num_blocks), [&](int64_t block) {
    const size_t begin = static_cast<size_t>(block) * kPointsOfBlock;
    sums[static_cast<size_t>(block)] =
        add(begin, std::min(begin + kPointsOfBlock, bundle.NumPoints()));
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace colmap_seapoint
