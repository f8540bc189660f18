// A cloud as a camera of its model sees it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

// Points are squares of point_size x point_size pixels, the nearest one in front, the first one of
// several at one depth; black where there is none. Every camera model, its distortion included: the
// picture lies over the photograph. A point so far outside of the field of view that the distortion
// folds it back into the picture is left out.
class CameraPicture {
 public:
  CameraPicture(const Camera& camera, const Rigid3d& cam_from_world, int point_size);
  void Add(const Eigen::Vector3d& xyz, const std::array<uint8_t, 3>& rgb);
  const ColorImage& Picture() const { return picture_; }

 private:
  Camera camera_;
  Rigid3d cam_from_world_;
  int point_size_;
  ColorImage picture_;
  FloatImage depth_;
};

}  // namespace colmap_seapoint
