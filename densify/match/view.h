// A posed picture, and what two of them show of one place: plain types that all rooms share.
#pragma once

#include <Eigen/Core>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

struct View {
  int image_idx = -1;  // place in SparseModel::images
  Camera camera;
  Rigid3d cam_from_world;
};

// Another picture that shows some of what a pair does; it is lent.
struct FurtherView {
  View view;
  const GrayImage* luma = nullptr;
  const GrayImage* mask = nullptr;  // as Picture::mask; none: empty or nullptr
};

// A pixel of picture 1 and the pixel of picture 2 that shows the same place.
struct PixelPair {
  Eigen::Vector2d pixel1, pixel2;
};

}  // namespace colmap_seapoint
