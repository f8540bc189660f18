// SeaPoints of a picture as a camera above the ground would see it (ours).
//
// Two pictures that look down at the ground aslant from different sides, as around an object, see
// it shortened in different directions; past some 20 degrees no SeaPoint is described alike. Drawn
// as from straight above, both show the same ground turned, which the matcher is made for. How far
// the camera was tilted need not be known well: of pictures around a bunch of bananas on a carpet,
// tilts of 40 and of 55 degrees tie 15 of 16, which 12,000 SeaPoints on 8 levels leave in 6 parts.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"
#include "feature/detector/seapoint_detector.h"

namespace colmap_seapoint {

struct TiltedView {
  Camera camera;      // a pinhole that looks straight down; its principal point may lie outside
  Features features;  // in the view's pixels
  std::vector<Eigen::Vector2d> in_picture;  // the same points, pixels of the picture
};

// The view of a camera that is held upright, `tilt_deg` (0 to 70) away from looking straight down
// at flat ground: its far side is at the top of the picture. What is farther than two and a half
// times the middle is left out. Twice the target interval, on kTiltedLevels levels. No features
// where the picture shows no such ground, or no texture. `mask`: empty, or of the picture's size.
// Runs on the caller's thread; the same every time. Cost: about 0.1 CPU s, whatever the picture's
// size.
TiltedView ExtractTiltedView(const GrayImage& picture, const GrayImage& mask, const Camera& camera,
                             double tilt_deg, const SeaPointExtractionOptions& options);

inline constexpr int kTiltedLevels = 3;

}  // namespace colmap_seapoint
