#include "examples/survey/alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

struct PosePair {
  Rigid3d truth, model;  // cam_from_world
};

std::vector<PosePair> CommonPoses(const SparseModel& truth, const SparseModel& model) {
  std::map<std::string, const PosedImage*> by_name;
  for (const PosedImage& image : truth.images) by_name[image.name] = &image;
  std::vector<PosePair> pairs;
  for (const PosedImage& image : model.images) {
    const auto found = by_name.find(image.name);
    if (found == by_name.end()) continue;
    pairs.push_back({found->second->cam_from_world, image.cam_from_world});
    by_name.erase(found);
  }
  return pairs;
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Similarity3d AlignByAttitudes(const std::vector<PosePair>& pairs, const Eigen::Matrix3Xd& from,
                              const Eigen::Matrix3Xd& to) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    sum += (pair.truth.rotation.conjugate() * pair.model.rotation).toRotationMatrix();
  }
  Similarity3d similarity;
  similarity.rotation = NearestRotation(sum);
  const Eigen::Vector3d from_mean = from.rowwise().mean(), to_mean = to.rowwise().mean();
  const Eigen::Matrix3Xd turned =
      similarity.rotation.toRotationMatrix() * (from.colwise() - from_mean);
  similarity.scale = turned.cwiseProduct(to.colwise() - to_mean).sum() / turned.squaredNorm();
  similarity.translation = to_mean - similarity.scale * (similarity.rotation * from_mean);
  return similarity;
}

// Second over first extent of the centres' cloud.
double Slenderness(const Eigen::Matrix3Xd& centres) {
  const Eigen::Matrix3Xd centred = centres.colwise() - centres.rowwise().mean();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(centred * centred.transpose());
  const double first = std::sqrt(svd.singularValues()(0));
  return first > 0 ? std::sqrt(svd.singularValues()(1)) / first : 0;
}

}  // namespace

CentreAlignment AlignCentres(const SparseModel& truth, const SparseModel& model, bool identity) {
  const std::vector<PosePair> pairs = CommonPoses(truth, model);
  const Eigen::Index n = static_cast<Eigen::Index>(pairs.size());
  CentreAlignment result;
  result.num_registered = static_cast<int>(pairs.size());
  if (!identity && n < 3) {
    throw Error("the estimated model",
                "has " + std::to_string(n) + " pictures in common with the survey",
                "at least 3 are needed to align it");
  }
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    from.col(i) = pairs[static_cast<size_t>(i)].model.OriginInSource();
    to.col(i) = pairs[static_cast<size_t>(i)].truth.OriginInSource();
  }
  if (!identity) {
    if ((from.colwise() - from.rowwise().mean()).norm() < 1e-12) {
      throw Error("the estimated model", "has all its cameras in one place", "map it again");
    }
    constexpr double kLine = 0.1;
    if (Slenderness(to) < kLine) {
      result.truth_from_model = AlignByAttitudes(pairs, from, to);
    } else {
      const Eigen::Matrix4d m = Eigen::umeyama(from, to, true);
      result.truth_from_model.scale = m.block<3, 1>(0, 0).norm();
      result.truth_from_model.rotation =
          Eigen::Matrix3d(m.block<3, 3>(0, 0) / result.truth_from_model.scale);
      result.truth_from_model.translation = m.block<3, 1>(0, 3);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const double error = (result.truth_from_model * from.col(i) - to.col(i)).norm();
    result.rms += error * error / static_cast<double>(n);
    result.max = std::max(result.max, error);
  }
  result.rms = std::sqrt(result.rms);
  return result;
}

Similarity3d RefineOnSurface(const Surface& surface, const std::vector<Eigen::Vector3f>& points,
                             const Similarity3d& start, double reach) {
  constexpr size_t kMaxPoints = 20000;
  constexpr int kIterations = 15;
  const size_t stride = std::max<size_t>(1, points.size() / kMaxPoints);
  Similarity3d similarity = start;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    // Unknowns: rotation vector, translation, relative scale, about the mean of the points.
    Eigen::Matrix<double, 7, 7> normal_matrix = Eigen::Matrix<double, 7, 7>::Identity() * 1e-9;
    Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero();
    const Eigen::Vector3d pivot = similarity * points.front().cast<double>();
    for (size_t i = 0; i < points.size(); i += stride) {
      const Eigen::Vector3d p = similarity * points[i].cast<double>();
      const Eigen::Vector3d place = surface.InGround(p);
      if (!surface.Ground().Grid().Contains(place.x(), place.y())) continue;
      const double rise = place.z() - surface.Ground().Height(place.x(), place.y());
      const double error = surface.Ground().Normal(place.x(), place.y()).z() * rise;
      const Eigen::Vector3d n = surface.GroundAt(place.x(), place.y()).normal;
      if (std::abs(error) > reach) continue;
      Eigen::Matrix<double, 7, 1> row;
      row << (p - pivot).cross(n), n, n.dot(p - pivot);
      normal_matrix += row * row.transpose();
      right -= row * error;
    }
    const Eigen::Matrix<double, 7, 1> step = normal_matrix.ldlt().solve(right);
    const double angle = step.head<3>().norm();
    Similarity3d delta;
    if (angle > 1e-15) {
      delta.rotation = Eigen::AngleAxisd(angle, step.head<3>() / angle);
    }
    delta.scale = 1 + step(6);
    delta.translation = pivot + step.segment<3>(3) - delta.scale * (delta.rotation * pivot);
    similarity = {delta.scale * similarity.scale,
                  (delta.rotation * similarity.rotation).normalized(),
                  delta * similarity.translation};
  }
  return similarity;
}

}  // namespace colmap_seapoint
