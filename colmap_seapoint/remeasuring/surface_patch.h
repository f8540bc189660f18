// A small piece of the surface as one picture shows it, and where others should show it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/remeasuring/surface_planes.h"
#include "feature/remeasuring/patch_matching.h"

namespace colmap_seapoint {

// Of the pixel that holds the point in its reference picture. World frame.
struct SurfacePatch {
  Eigen::Vector3d middle;
  Eigen::Vector3f across, down;  // what a pixel across and down is on the surface
  // How far the places a span of pixels to either side lie, on their mean, from the middle: lens
  // and perspective are not affine.
  Eigen::Vector3f bend_across, bend_down;
};

struct PredictedPatch {
  PredictedPlace place;
  // How far the mean of the patch lies from its middle, pixels: matching finds the mean. Up to a
  // hundredth of a pixel in the corners of a wide lens, and the same in all pictures of a survey: a
  // transect of 200 metres was bent by centimetres.
  Eigen::Vector2d bend = Eigen::Vector2d::Zero();
};

// `pixel`: of the reference picture. `plane`: in its camera's frame. nullopt where the plane is not
// seen all around.
std::optional<SurfacePatch> PatchOnPlane(const Camera& camera, const Rigid3d& cam_from_world,
                                         const SeenPlane& plane, const Eigen::Vector2d& pixel);

// The affine warp between the two pictures there, from the patch's mean: all of projection and lens
// is in it. nullopt where the patch is not in front of the camera.
std::optional<PredictedPatch> PredictPatch(const Camera& camera, const Rigid3d& cam_from_world,
                                           const SurfacePatch& patch);

}  // namespace colmap_seapoint
