#include "feature/matching/two_view_verification.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace colmap_seapoint {

namespace {

constexpr double kConfidence = 0.9999;
constexpr int kMaxIterations = 5000;

struct Correspondences {
  std::vector<cv::Point2d> pixels1, pixels2;  // as they are in the pictures
  std::vector<cv::Point2d> rays1, rays2;      // on the plane z = 1, undistorted
  bool has_rays = true;                       // false: some pixel has no ray under its camera
};

Correspondences Collect(const Camera& camera1, const std::vector<SeaPoint>& points1,
                        const Camera& camera2, const std::vector<SeaPoint>& points2,
                        const FeatureMatches& matches) {
  Correspondences all;
  for (const FeatureMatch& match : matches) {
    const SeaPoint& a = points1[match.idx1];
    const SeaPoint& b = points2[match.idx2];
    all.pixels1.emplace_back(a.x, a.y);
    all.pixels2.emplace_back(b.x, b.y);
    const auto ray1 = camera1.CamFromImg({a.x, a.y});
    const auto ray2 = camera2.CamFromImg({b.x, b.y});
    all.has_rays = all.has_rays && ray1 && ray2;
    if (!all.has_rays) continue;
    all.rays1.emplace_back(ray1->x(), ray1->y());
    all.rays2.emplace_back(ray2->x(), ray2->y());
  }
  return all;
}

struct RobustModel {
  cv::Mat matrix;  // 3 x 3, or empty
  std::vector<uint8_t> mask;
  int num_inliers = 0;
};

// Runs one of OpenCV's estimators; what it cannot estimate is an empty model, not an error.
template <typename Estimator>
RobustModel Estimate(size_t num_matches, const Estimator& estimator) {
  RobustModel model;
  try {
    model.matrix = estimator(&model.mask);
  } catch (const cv::Exception&) {
    model.matrix.release();
  }
  if (model.matrix.rows != 3 || model.matrix.cols != 3 || model.mask.size() != num_matches) {
    return RobustModel();
  }
  model.num_inliers = static_cast<int>(std::count(model.mask.begin(), model.mask.end(), 1));
  return model;
}

Eigen::Matrix3d ToEigen(const cv::Mat& matrix) {
  Eigen::Matrix3d result;
  cv::cv2eigen(matrix, result);
  return result;
}

// The Sampson error of x2' [t]x R x1, in units of the normalised image plane.
struct SampsonError {
  Eigen::Vector3d ray1, ray2;

  template <typename T>
  bool operator()(const T* const rotation, const T* const translation, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> q(rotation);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> t(translation);
    const Eigen::Matrix<T, 3, 1> x1 = ray1.cast<T>(), x2 = ray2.cast<T>();
    const Eigen::Matrix<T, 3, 1> line2 = t.cross(q * x1);                // E x1
    const Eigen::Matrix<T, 3, 1> line1 = q.conjugate() * (x2.cross(t));  // E' x2
    const T squared = line1.x() * line1.x() + line1.y() * line1.y() + line2.x() * line2.x() +
                      line2.y() * line2.y();
    residual[0] = x2.dot(line2) / ceres::sqrt(squared + T(1e-20));
    return true;
  }
};

void RefinePose(const Correspondences& all, const std::vector<uint8_t>& mask, double max_error,
                Rigid3d* pose) {
  ceres::Problem problem;
  double* rotation = pose->rotation.coeffs().data();
  double* translation = pose->translation.data();
  for (size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    auto* cost = new ceres::AutoDiffCostFunction<SampsonError, 1, 4, 3>(
        new SampsonError{{all.rays1[i].x, all.rays1[i].y, 1}, {all.rays2[i].x, all.rays2[i].y, 1}});
    problem.AddResidualBlock(cost, new ceres::CauchyLoss(0.5 * max_error), rotation, translation);
  }
  problem.SetManifold(rotation, new ceres::EigenQuaternionManifold);
  problem.SetManifold(translation, new ceres::SphereManifold<3>);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 25;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  pose->rotation.normalize();
}

// From the essential matrix of the inliers to the relative pose with unit translation, refined.
std::optional<Rigid3d> RelativePose(const Correspondences& all, const std::vector<uint8_t>& inliers,
                                    double max_error) {
  if (!all.has_rays) return std::nullopt;
  Correspondences kept;
  for (size_t i = 0; i < inliers.size(); ++i) {
    if (!inliers[i]) continue;
    kept.rays1.push_back(all.rays1[i]);
    kept.rays2.push_back(all.rays2[i]);
  }
  const cv::Mat identity = cv::Mat::eye(3, 3, CV_64F);
  const RobustModel essential = Estimate(kept.rays1.size(), [&](std::vector<uint8_t>* mask) {
    return cv::findEssentialMat(kept.rays1, kept.rays2, identity, cv::USAC_MAGSAC, kConfidence,
                                max_error, *mask);
  });
  if (essential.num_inliers < 8) return std::nullopt;
  cv::Mat rotation, translation, mask(essential.mask, true);
  if (cv::recoverPose(essential.matrix, kept.rays1, kept.rays2, identity, rotation, translation,
                      mask) < 8) {
    return std::nullopt;
  }
  Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(ToEigen(rotation)).normalized();
  cv::cv2eigen(translation, pose.translation);
  pose.translation.normalize();
  RefinePose(kept, essential.mask, max_error, &pose);
  return pose;
}

Eigen::Matrix3d EssentialFromPose(const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  return cross * pose.rotation.toRotationMatrix();
}

// E on rays where the focal lengths are known, F on pixels where not.
RobustModel EstimateEpipolar(const Correspondences& all, bool calibrated, double max_error,
                             double max_ray_error) {
  return Estimate(all.pixels1.size(), [&](std::vector<uint8_t>* mask) {
    if (!calibrated) {
      return cv::findFundamentalMat(all.pixels1, all.pixels2, cv::USAC_MAGSAC, max_error,
                                    kConfidence, kMaxIterations, *mask);
    }
    return cv::findEssentialMat(all.rays1, all.rays2, cv::Mat::eye(3, 3, CV_64F), cv::USAC_MAGSAC,
                                kConfidence, max_ray_error, *mask);
  });
}

RobustModel EstimateHomography(const Correspondences& all, double max_error) {
  return Estimate(all.pixels1.size(), [&](std::vector<uint8_t>* mask) {
    return cv::findHomography(all.pixels1, all.pixels2, cv::USAC_MAGSAC, max_error, *mask,
                              kMaxIterations, kConfidence);
  });
}

TwoViewConfig ConfigOf(const RobustModel& epipolar, const RobustModel& homography, bool calibrated,
                       const TwoViewVerificationOptions& options) {
  const bool is_planar =
      homography.num_inliers >= options.min_num_inliers &&
      homography.num_inliers >= options.max_homography_ratio * epipolar.num_inliers;
  if (is_planar) return TwoViewConfig::kPlanarOrPanoramic;
  return calibrated ? TwoViewConfig::kCalibrated : TwoViewConfig::kUncalibrated;
}

}  // namespace

TwoViewGeometry VerifyTwoViews(const Camera& camera1, const std::vector<SeaPoint>& points1,
                               const Camera& camera2, const std::vector<SeaPoint>& points2,
                               const FeatureMatches& matches,
                               const TwoViewVerificationOptions& options) {
  TwoViewGeometry geometry;
  geometry.config = TwoViewConfig::kDegenerate;
  if (static_cast<int>(matches.size()) < options.min_num_inliers) return geometry;

  const Correspondences all = Collect(camera1, points1, camera2, points2, matches);
  const bool calibrated =
      camera1.has_prior_focal_length && camera2.has_prior_focal_length && all.has_rays;
  const double max_ray_error =
      0.5 * options.max_error * (1 / camera1.MeanFocal() + 1 / camera2.MeanFocal());
  const RobustModel epipolar = EstimateEpipolar(all, calibrated, options.max_error, max_ray_error);
  const RobustModel homography = EstimateHomography(all, options.max_error);
  const RobustModel& best = homography.num_inliers > epipolar.num_inliers ? homography : epipolar;
  if (best.num_inliers < options.min_num_inliers) return geometry;

  geometry.config = ConfigOf(epipolar, homography, calibrated, options);
  for (size_t i = 0; i < matches.size(); ++i) {
    if (best.mask[i]) geometry.inliers.push_back(matches[i]);
  }
  geometry.cam2_from_cam1 = RelativePose(all, best.mask, max_ray_error);
  if (homography.num_inliers > 0) geometry.H = ToEigen(homography.matrix);
  if (!calibrated && epipolar.num_inliers > 0) geometry.F = ToEigen(epipolar.matrix);
  if (geometry.cam2_from_cam1) {
    geometry.E = EssentialFromPose(*geometry.cam2_from_cam1);
  } else if (calibrated && epipolar.num_inliers > 0) {
    geometry.E = ToEigen(epipolar.matrix);
  }
  return geometry;
}

}  // namespace colmap_seapoint
