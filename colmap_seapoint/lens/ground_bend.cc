#include "colmap_seapoint/lens/ground_bend.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinCommonPoints = 10;
constexpr double kWayInDistances = 5;
// Of the singular values' range: what the pictures do not spread over is not asked for.
constexpr double kRankThreshold = 1e-3;

Eigen::Vector3d MeanOf(const std::vector<Eigen::Vector3d>& places) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) sum += place;
  return sum / static_cast<double>(places.size());
}

// The directions of a cloud's spread, the narrowest first, in columns.
Eigen::Matrix3d SpreadOf(const std::vector<Eigen::Vector3d>& places) {
  const Eigen::Vector3d mean = MeanOf(places);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& place : places) {
    spread += (place - mean) * (place - mean).transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
}

std::vector<Eigen::Vector3d> CentresOf(const SparseModel& model) {
  std::vector<Eigen::Vector3d> centres;
  for (const PosedImage& image : model.images) {
    centres.push_back(image.cam_from_world.OriginInSource());
  }
  return centres;
}

double MedianDepth(const SparseModel& model) {
  std::vector<double> depths;
  for (const PosedImage& image : model.images) {
    for (const uint64_t id : image.point3D_ids) {
      const auto point = model.points3D.find(id);
      if (point == model.points3D.end()) continue;
      depths.push_back((image.cam_from_world * point->second.xyz).z());
    }
  }
  return depths.empty() ? 0 : UpperMedian(std::move(depths));
}

// What the least-squares coefficient of u^2, of values at these places, multiplies each value by.
Eigen::VectorXd SquareWeights(const std::vector<Eigen::Vector3d>& places, const GroundFrame& frame,
                              double scale) {
  Eigen::MatrixXd design(static_cast<Eigen::Index>(places.size()), 6);
  for (Eigen::Index i = 0; i < design.rows(); ++i) {
    const Eigen::Vector3d off = places[static_cast<size_t>(i)] - frame.centre;
    const double u = frame.along.dot(off) / scale, v = frame.across.dot(off) / scale;
    design.row(i) << 1, u, v, u * u, u * v, v * v;
  }
  // By the normal equations: the places may be hundreds of thousands.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(kRankThreshold * kRankThreshold);
  solver.compute(design.transpose() * design);
  return design * solver.solve(Eigen::VectorXd::Unit(6, 3)) / (scale * scale);
}

// Half of the way along that the places take up.
double HalfLength(const std::vector<Eigen::Vector3d>& places, const GroundFrame& frame) {
  double half = 0;
  for (const Eigen::Vector3d& place : places) {
    half = std::max(half, std::abs(frame.along.dot(place - frame.centre)));
  }
  return half;
}

}  // namespace

std::optional<GroundFrame> FindGroundFrame(const SparseModel& model) {
  const std::vector<Eigen::Vector3d> centres = CentresOf(model);
  GroundFrame frame;
  frame.distance = MedianDepth(model);
  if (centres.size() < 3 || !(frame.distance > 0)) return std::nullopt;
  frame.centre = MeanOf(centres);
  frame.along = SpreadOf(centres).col(2);
  // Up is what the points spread least in, or where they are few, as the cameras look.
  std::vector<Eigen::Vector3d> points;
  for (const auto& [id, point] : model.points3D) points.push_back(point.xyz);
  frame.up = SpreadOf(points).col(0);
  frame.up = (frame.up - frame.up.dot(frame.along) * frame.along).normalized();
  frame.across = frame.up.cross(frame.along);
  if (!frame.up.allFinite() || !(HalfLength(centres, frame) > 0)) return std::nullopt;
  return frame;
}

std::vector<Eigen::Vector3d> CurvatureWeights(const SparseModel& model, const GroundFrame& frame) {
  constexpr size_t kMinPictures = 4;
  if (model.images.size() < kMinPictures) return {};
  const std::vector<Eigen::Vector3d> centres = CentresOf(model);
  const Eigen::VectorXd weights = SquareWeights(centres, frame, HalfLength(centres, frame));
  std::vector<Eigen::Vector3d> by_picture;
  for (const double weight : weights) by_picture.push_back(weight * frame.up);
  return by_picture;
}

double CurvatureOf(const std::vector<Eigen::Vector3d>& places, const Eigen::VectorXd& heights,
                   const GroundFrame& frame) {
  return SquareWeights(places, frame, HalfLength(places, frame)).dot(heights);
}

double CurvatureBetween(const SparseModel& a, const SparseModel& b, const GroundFrame& frame) {
  std::vector<Eigen::Vector3d> of_a, of_b;
  for (const auto& [id, point] : a.points3D) {
    const auto other = b.points3D.find(id);
    if (other == b.points3D.end()) continue;
    of_a.push_back(point.xyz);
    of_b.push_back(other->second.xyz);
  }
  if (of_a.size() < kMinCommonPoints) return 0;
  Eigen::Matrix3Xd places_a(3, of_a.size()), places_b(3, of_a.size());
  for (size_t i = 0; i < of_a.size(); ++i) {
    places_a.col(static_cast<Eigen::Index>(i)) = of_a[i];
    places_b.col(static_cast<Eigen::Index>(i)) = of_b[i];
  }
  const Eigen::Matrix4d a_from_b = Eigen::umeyama(places_b, places_a);
  const Eigen::Matrix3Xd apart = ((a_from_b.topLeftCorner<3, 3>() * places_b).colwise() +
                                  Eigen::Vector3d(a_from_b.topRightCorner<3, 1>())) -
                                 places_a;
  return CurvatureOf(of_a, apart.transpose() * frame.up, frame);
}

GroundBend BendInGsd(double curvature, const SparseModel& model, const GroundFrame& frame) {
  if (model.cameras.empty()) return {};
  const double half_length = HalfLength(CentresOf(model), frame);
  const double half_way = std::min(0.5 * kWayInDistances * frame.distance, half_length);
  const double gsd = frame.distance / model.cameras.begin()->second.MeanFocal();
  return {curvature * half_way * half_way / gsd, curvature * half_length * half_length / gsd};
}

}  // namespace colmap_seapoint
