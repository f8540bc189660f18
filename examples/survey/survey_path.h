// The demo survey: what is flown, and where the camera is in every picture.
#pragma once

#include <string>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct SurveyOptions {
  int seed = 1;
  int num_strips = 2;
  int images_per_strip = 6;
  int revisit = 0;                // pictures taken over the first strip again, at the end
  int width = 1360;               // pixels
  int height = 1024;              // pixels
  double forward_overlap = 0.75;  // share of a picture seen again in the next one
  double side_overlap = 0.5;      // share of a picture seen again in the next strip
  double altitude = 2;            // metres above the mean seabed
  double field_of_view_deg = 60;  // horizontal, under water
  double relief = 1;              // factor on all heights of the seabed; 0 = a plane
  double turbidity = 0.3;         // 0 clear ... 1 murky
  double caustics = 0;            // 0 none ... 1 strong sunlight through waves
  double marine_snow = 0;         // 0 none ... 1 heavy
  double noise = 1;               // factor on the sensor's noise
  double jitter = 1;              // factor on the vehicle's unsteadiness
  std::string image_format = "jpg";
  int num_threads = -1;
};

// "" or the whole sentence: option, value, rule.
std::string CheckSurveyOptions(const SurveyOptions& options);

// Metres a pixel at the planned altitude.
double NominalGsd(const SurveyOptions& options);

// One OPENCV camera with real distortion; a lawn-mower path in metres, z up, the camera looking
// down. The vehicle turns between strips, so the pictures of every other strip are upside down.
// A revisit follows the first strip from its beginning, a little lower and at a slant to its
// course, as a vehicle that holds against a current. Images are named in the order in which they
// are taken; no points.
SparseModel PlanSurvey(const SurveyOptions& options);

struct Rectangle {
  double min_x, min_y, max_x, max_y;  // metres
};

// The part of the ground that a picture can see when no seabed lies below `lowest`.
Rectangle Footprint(const Camera& camera, const Rigid3d& cam_from_world, double lowest);

Rectangle Union(const Rectangle& a, const Rectangle& b);

}  // namespace colmap_seapoint
