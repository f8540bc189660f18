// Least-squares matching (ours; Ackermann 1984, Gruen 1985): where another picture shows a patch of
// a reference picture, to some hundredths of a pixel.
//
// What the patch should look like there is predicted by an affine warp; the patch is searched for
// around the predicted place by its correlation, and from the best whole pixel on the place (and,
// when asked for, the warp) that explains the grey values best is found by least squares. Gain and
// offset of the grey values are free.
#pragma once

#include <Eigen/Core>

#include "colmap_seapoint/base/image.h"
#include "feature/remeasuring/reference_patch.h"

namespace colmap_seapoint {

enum class PatchWarp {
  kShift,   // as predicted; only the place is measured
  kAffine,  // all six parameters are measured
};

struct PatchMatchOptions {
  PatchWarp warp = PatchWarp::kShift;
  double min_correlation = 0.7;
};

// Where the middle of the patch should be, pixels in COLMAP's frame, and what one pixel across and
// down in the reference picture is there.
struct PredictedPlace {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix2d other_from_reference = Eigen::Matrix2d::Identity();
};

enum class PatchMatchStatus {
  kMatched,
  kOutside,    // the patch, with what it is searched in, does not lie within the picture
  kNoTexture,  // nothing in the patch that would hold it in both directions
  kDiverged,   // best at the rim of the search, or the least squares lead away
  kUnlike,     // nothing there looks like it
};

struct PatchMatch {
  PatchMatchStatus status = PatchMatchStatus::kUnlike;
  // When matched:
  PredictedPlace place;    // as measured
  double sigma = 0;        // standard deviation in the direction known worst, pixels
  double correlation = 0;  // there
};

// Finds the patch up to 3 pixels (of the reference) from the predicted place. The picture should
// not have more pixels on the patch than the reference has. Any numbers are allowed. The same bytes
// on every machine. About 8 microseconds.
PatchMatch MatchPatch(const ReferencePatch& reference, const GrayImage& picture,
                      const PredictedPlace& predicted, const PatchMatchOptions& options);

}  // namespace colmap_seapoint
