// The model that COLMAP's mapper returns, as plain values. Frames: "world" is the model's own frame
// (metric only when the model was georeferenced); "cam" is x right, y down, z forward.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

inline constexpr uint64_t kNoPoint3D = std::numeric_limits<uint64_t>::max();

struct PosedImage {
  uint32_t image_id = 0;
  uint32_t camera_id = 0;
  std::string name;  // relative to the image folder, '/' between folders
  Rigid3d cam_from_world;
  std::vector<Eigen::Vector2d> points2D;  // pixels
  std::vector<uint64_t> point3D_ids;      // same length; kNoPoint3D where none
};

struct SparsePoint {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb = {0, 0, 0};
  double error = 0;  // mean reprojection error, pixels
  struct TrackElement {
    uint32_t image_id;
    uint32_t point2D_idx;
  };
  std::vector<TrackElement> track;
};

struct SparseModel {
  std::map<uint32_t, Camera> cameras;
  std::vector<PosedImage> images;  // in the order of images.bin / images.txt (.vis indexes it)
  std::map<uint64_t, SparsePoint> points3D;
};

}  // namespace colmap_seapoint
