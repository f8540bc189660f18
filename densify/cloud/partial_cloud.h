// The points that one pair adds (paper 2.6): the partial local cloud, in the model's frame.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

struct DensePoint {
  Eigen::Vector3f xyz;     // world
  Eigen::Vector3f normal;  // world, unit, towards the camera
  std::array<uint8_t, 3> rgb;
  float confidence;  // 0..1: how probable it is that it lies on the surface (match/confidence.h)
};

struct PartialCloud {
  int image_idx1 = -1;  // every point of the cloud was seen by these two pictures
  int image_idx2 = -1;
  std::vector<DensePoint> points;
};

}  // namespace colmap_seapoint
