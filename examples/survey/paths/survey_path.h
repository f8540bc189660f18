// Where the camera is in every picture.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"
#include "examples/survey/paths/survey_options.h"
#include "examples/survey/paths/survey_port.h"

namespace colmap_seapoint {

// Of the seabed (z up) in the world: the identity, but for a wall, whose seabed is turned upright
// about x.
Rigid3d WorldFromGround(const SurveyOptions& options);

// One camera and the poses of all pictures, cam_from_world, metres; no points. Images are named,
// and numbered, in the order in which they are taken (kRandom: in another).
//   Strips: the camera looks down. The vehicle turns between strips, so the pictures of every other
// strip are upside down. A revisit follows the first strip from its beginning, a little lower and
// at a slant to its course, as a vehicle that holds against a current.
//   Swim: the same track; the camera looks ahead, `pitch_deg` below the horizon.
//   Wall: rows one above the other, sideways; what is the heading of the others is up.
//   Circle, statue: rings one above the other around the origin, counted from the lowest.
//   Descent: each dive from 3 x altitude to 1 x, in steps of one ratio.
SparseModel PlanSurvey(const SurveyOptions& options);

struct Rectangle {
  double min_x, min_y, max_x, max_y;  // metres, ground's frame
};

// What a picture can see of a seabed no lower than `lowest`, no farther than `reach` metres from
// the camera on the plan. `cam_from_ground`: ground's frame, z up.
Rectangle Footprint(const PortCamera& camera, const Rigid3d& cam_from_ground, double lowest,
                    double reach);

// What has to be there of the seabed for all pictures.
Rectangle SurveyArea(const SurveyOptions& options, const SparseModel& model, double lowest);

}  // namespace colmap_seapoint
