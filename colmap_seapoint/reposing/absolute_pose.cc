#include "colmap_seapoint/reposing/absolute_pose.h"

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace colmap_seapoint {
namespace {

constexpr size_t kMinPlaces = 6;
constexpr int kMaxSamples = 1000;
constexpr double kConfidence = 0.9999;

Rigid3d FromOpenCv(const cv::Vec3d& turn, const cv::Vec3d& shift) {
  const Eigen::Vector3d axis(turn[0], turn[1], turn[2]);
  Rigid3d pose;
  if (axis.norm() > 0) {
    pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(axis.norm(), axis.normalized()));
  }
  pose.translation = {shift[0], shift[1], shift[2]};
  return pose;
}

}  // namespace

int CountInliers(const Camera& camera, const Rigid3d& cam_from_world,
                 const std::vector<SeenPlace>& places, double max_error) {
  int count = 0;
  for (const SeenPlace& place : places) {
    const auto pixel = camera.ImgFromCam(cam_from_world * place.xyz);
    count += pixel && (*pixel - place.pixel).squaredNorm() <= max_error * max_error;
  }
  return count;
}

std::optional<Rigid3d> FindAbsolutePose(const Camera& camera, const std::vector<SeenPlace>& places,
                                        double max_error) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (const SeenPlace& place : places) {
    const auto ray = camera.CamFromImg(place.pixel);
    if (!ray || !place.xyz.allFinite()) continue;
    points.emplace_back(place.xyz.x(), place.xyz.y(), place.xyz.z());
    rays.emplace_back(ray->x(), ray->y());
  }
  if (rays.size() < kMinPlaces) return std::nullopt;
  cv::Vec3d turn, shift;
  std::vector<int> inliers;
  try {
    // OpenCV seeds its random numbers anew in every call.
    const bool is_found = cv::solvePnPRansac(
        points, rays, cv::Matx33d::eye(), cv::noArray(), turn, shift, false, kMaxSamples,
        static_cast<float>(max_error / camera.MeanFocal()), kConfidence, inliers, cv::SOLVEPNP_P3P);
    if (!is_found || inliers.size() < kMinPlaces) return std::nullopt;
    std::vector<cv::Point3d> near_points;
    std::vector<cv::Point2d> near_rays;
    for (const int i : inliers) {
      near_points.push_back(points[static_cast<size_t>(i)]);
      near_rays.push_back(rays[static_cast<size_t>(i)]);
    }
    cv::solvePnPRefineLM(near_points, near_rays, cv::Matx33d::eye(), cv::noArray(), turn, shift);
  } catch (const cv::Exception&) {
    return std::nullopt;  // degenerate samples
  }
  const Rigid3d pose = FromOpenCv(turn, shift);
  if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) return std::nullopt;
  return pose;
}

}  // namespace colmap_seapoint
