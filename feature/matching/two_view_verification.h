// Geometric verification of a pair: E, F and H by robust estimation (OpenCV's USAC), the right
// COLMAP configuration, and the relative pose refined with Ceres.
#pragma once

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/features.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

// Verifies `matches`. The config is kDegenerate when fewer than min_num_inliers matches agree on
// any model; else kPlanarOrPanoramic (H) when a homography explains max_homography_ratio of the
// inliers, kCalibrated (E) when both focal lengths are priors, kUncalibrated (F) when not.
// cam2_from_cam1 is set whenever a pose could be decomposed, with the cameras' present intrinsics.
// Deterministic: the estimators start from fixed seeds, and nothing depends on the number of
// threads.
TwoViewGeometry VerifyTwoViews(const Camera& camera1, const std::vector<SeaPoint>& points1,
                               const Camera& camera2, const std::vector<SeaPoint>& points2,
                               const FeatureMatches& matches,
                               const TwoViewVerificationOptions& options);

}  // namespace colmap_seapoint
