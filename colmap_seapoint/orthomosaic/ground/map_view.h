// A picture of the model, as one looks from the map into it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

class MapView {
 public:
  MapView(const Camera& camera, const Rigid3d& cam_from_map);

  // The pixel of a place of the map; nullopt behind the camera, outside of the picture, and so far
  // outside of the field of view that the distortion folds it back into the picture.
  std::optional<Eigen::Vector2d> PixelOf(const Eigen::Vector3d& place) const {
    return PixelOfInCam(InCam(place));
  }
  // The same in two steps.
  Eigen::Vector3d InCam(const Eigen::Vector3d& place) const {
    return rotation_ * place + translation_;
  }
  std::optional<Eigen::Vector2d> PixelOfInCam(const Eigen::Vector3d& in_cam) const {
    if (!(in_cam.z() > 0)) return std::nullopt;
    if (in_cam.head<2>().squaredNorm() > max_tan2_ * in_cam.z() * in_cam.z()) return std::nullopt;
    const std::optional<Eigen::Vector2d> pixel = camera_.ImgFromCam(in_cam);
    if (!pixel || !camera_.InImage(*pixel)) return std::nullopt;
    return pixel;
  }
  double DepthOf(const Eigen::Vector3d& place) const {  // the distance along the axis
    return rotation_.row(2).dot(place) + translation_.z();
  }
  // The size on the ground of a pixel there: the depth over the focal length.
  double GsdAt(const Eigen::Vector3d& place) const { return DepthOf(place) / camera_.MeanFocal(); }
  const Eigen::Vector3d& Center() const { return center_; }
  const Camera& GetCamera() const { return camera_; }
  const Eigen::Matrix3d& Rotation() const { return rotation_; }  // cam_from_map

  // low x, low y, high x, high y of what it may see of places between two heights; nullopt when
  // that is nothing. Rays are followed as far as `max_reach` from the camera.
  std::optional<std::array<double, 4>> Footprint(double low, double high, double max_reach) const;

 private:
  Camera camera_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_, center_;
  std::vector<Eigen::Vector3d> border_;  // directions in the camera frame, z = 1
  double max_tan2_ = 0;                  // squared tangent of the widest angle from the axis
};

// In the order of the model's images.
std::vector<MapView> MakeMapViews(const SparseModel& model, const Rigid3d& map_from_cloud);

// The survey's ground sampling distance: the median over the points of what the picture that sees
// it best has; nullopt when no picture sees more than half of them. (What hides a point is not
// looked for.)
std::optional<double> SurveyGsd(const std::vector<MapView>& views,
                                const std::vector<Eigen::Vector3d>& points);

}  // namespace colmap_seapoint
