// The survey's camera: one lens with real distortion.
#pragma once

#include <Eigen/Core>

#include "colmap_seapoint/base/camera.h"
#include "examples/survey/paths/survey_options.h"

namespace colmap_seapoint {

// Camera 1: OPENCV, or OPENCV_FISHEYE (nearly equidistant).
Camera MakeSurveyCamera(const SurveyOptions& options);

// Tangent of the largest angle from the axis at which the lens forms a picture. Fisheye pictures
// whose corners lie farther out are black there.
double MaxTangent(const Camera& camera);

// Metres a pixel at a place seen by the camera: its depth (fisheye: its distance) over the focal
// length.
double GsdAt(const Camera& camera, const Eigen::Vector3d& point_in_cam);

}  // namespace colmap_seapoint
