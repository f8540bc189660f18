// The plain values that the feature stages hand on: SeaPoints, their descriptors, matches, two-view
// geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

// A SeaPoint (paper 2.3). Coordinates are in pixels of the full-size picture, the centre of the
// first pixel is (0.5, 0.5).
struct SeaPoint {
  float x = 0;
  float y = 0;
  float scale = 1;  // pixels of the full-size picture per pixel of the level it was found on
  // Radians, of the intensity centroid; 0 is to the right, positive is downwards.
  float orientation = 0;
};

// rBRIEF, 256 tests; bit i of the descriptor is bit i % 8 of byte i / 8.
using Descriptor = std::array<uint8_t, 32>;

// Upright RootSIFT in COLMAP's own form, of Euclidean length 512 but for rounding (paper 4).
using SiftDescriptor = std::array<uint8_t, 128>;

// rBRIEF is always there: the vote on how far two pictures are turned, guided matching and whatever
// wants short descriptors stay as they are. SIFT comes on top where it was asked for, and takes the
// place of rBRIEF only between two pictures that both have it: pictures with and without it can be
// mixed in one database.
struct Features {
  std::vector<SeaPoint> points;
  std::vector<Descriptor> descriptors;           // same length
  std::vector<SiftDescriptor> sift_descriptors;  // same length, or empty: not asked for
};

struct FeatureMatch {
  uint32_t idx1 = 0;  // into the first picture's points
  uint32_t idx2 = 0;
  friend bool operator==(const FeatureMatch& a, const FeatureMatch& b) {
    return a.idx1 == b.idx1 && a.idx2 == b.idx2;
  }
};
using FeatureMatches = std::vector<FeatureMatch>;

// COLMAP's TwoViewGeometry::ConfigurationType.
enum class TwoViewConfig : int {
  kUndefined = 0,
  kDegenerate = 1,
  kCalibrated = 2,
  kUncalibrated = 3,
  kPlanar = 4,
  kPanoramic = 5,
  kPlanarOrPanoramic = 6,
};

struct TwoViewGeometry {
  TwoViewConfig config = TwoViewConfig::kUndefined;
  FeatureMatches inliers;
  std::optional<Eigen::Matrix3d> F;       // x2' F x1 = 0, pixels
  std::optional<Eigen::Matrix3d> E;       // normalised coordinates
  std::optional<Eigen::Matrix3d> H;       // x2 = H x1, pixels
  std::optional<Rigid3d> cam2_from_cam1;  // unit translation (or zero: panoramic)
};

}  // namespace colmap_seapoint
