// Exact pictures of coded markers on a plane.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

// On the plane z = `centre.z()`, x to the right and y down as a camera at z = 0 sees it.
struct PlaneMarker {
  MarkerName name;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double size = 0.1;  // of the black square
  double turn = 0;    // radians, clockwise
  bool is_mirrored = false;

  Eigen::Vector3d Corner(int k) const;  // of the black square, one after the other
};

struct Water {
  double contrast = 1;  // 1: white is 200 and black 30
  double noise = 0;     // standard deviation, grey values
  int blur = 0;         // passes of a 3 x 3 mean
  double uneven = 0;    // share by which the light falls from the left to the right
};

// The plane is grey with smooth blotches; each pixel is the mean of 4 x 4 rays.
GrayImage MarkerPicture(const std::vector<PlaneMarker>& markers, const Camera& camera,
                        const Rigid3d& cam_from_world, const Water& water = {});

}  // namespace colmap_seapoint
