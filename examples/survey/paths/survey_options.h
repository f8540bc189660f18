// What is dived in a demo survey, with which camera, in what water.
#pragma once

#include <string>

#include "colmap_seapoint/base/camera.h"
#include "examples/survey/paths/survey_port.h"

namespace colmap_seapoint {

enum class SurveyPath {
  kStrips,   // lawn-mower over the seabed, camera straight down
  kRandom,   // the same pictures, their file names in random order
  kSwim,     // a diver's swim: forward along the lanes, camera ahead and down
  kCircle,   // rings around a boulder on the seabed, looking at it
  kStatue,   // rings around a statue with overhangs, looking inwards
  kWall,     // rows along a vertical wall, camera level
  kDescent,  // dives straight down, from 3 x the altitude to 1 x, camera down
};

struct SurveyOptions {
  SurveyPath path = SurveyPath::kStrips;
  int seed = 1;
  int num_strips = 2;  // strips, lanes, rows, rings or dives
  // Pictures of each. 0 (rings and dives only): as many as forward_overlap asks for.
  int images_per_strip = 6;
  int revisit = 0;                // pictures taken over the first strip again, at the end
  int width = 1360;               // pixels
  int height = 1024;              // pixels
  double forward_overlap = 0.75;  // share of a picture seen again in the next one
  double side_overlap = 0.5;      // share of a picture seen again in the next strip
  double altitude = 2;            // metres above the mean seabed, or to wall and statue
  double pitch_deg = 30;          // of a swim: below the horizon
  double roll_deg = 0;            // of every second picture against the first, about its axis
  double max_range = 0;           // metres; what is farther is lost in the water; 0: MaxRange()
  CameraModel camera_model = CameraModel::kOpenCV;  // or kOpenCVFisheye
  double field_of_view_deg = 60;                    // horizontal, under water
  PortOptions port;                                 // between camera and water
  double relief = 1;         // factor on all heights of the seabed; 0 = a plane
  double turbidity = 0.3;    // 0 clear ... 1 murky
  double caustics = 0;       // 0 none ... 1 strong sunlight through waves
  double marine_snow = 0;    // 0 none ... 1 heavy
  double noise = 1;          // factor on the sensor's noise
  double jitter = 1;         // factor on the vehicle's unsteadiness
  int markers = 0;           // scale bars of two coded markers on the seabed
  double marker_size = 0.1;  // side of their black squares, metres
  double marker_bar = 1;     // metres between the centres of a bar, on the map
  std::string image_format = "jpg";
  int num_threads = -1;
};

// By the names of the command line; throws UsageError for others.
SurveyPath ParseSurveyPath(const std::string& name);
CameraModel ParseSurveyCameraModel(const std::string& name);
PortKind ParsePortKind(const std::string& name);
std::string SurveyPathName(SurveyPath path);
std::string PortKindName(PortKind kind);

// "" or the whole sentence: option, value, rule.
std::string CheckSurveyOptions(const SurveyOptions& options);

// Whether pictures may show water and nothing behind it. Where they may not (a perspective camera
// that looks straight down), nothing limits the range.
bool ShowsOpenWater(const SurveyOptions& options);

// How far the camera sees, metres: what is nearer is in the pictures in full, and counts as seen;
// up to kFadeOut times that it fades. Infinite without open water.
double MaxRange(const SurveyOptions& options);
inline constexpr double kFadeOut = 1.25;

// Pixels, or pixels a radian on the axis (fisheye).
double NominalFocal(const SurveyOptions& options);
// Metres a pixel at the planned altitude.
double NominalGsd(const SurveyOptions& options);

// What stands in the origin of a circle or a statue survey, metres. It grows with the altitude, so
// that a picture holds it.
double BoulderRadius(const SurveyOptions& options);
double BoulderHeight(const SurveyOptions& options);
double StatueHeight(const SurveyOptions& options);
double StatueRadius(const SurveyOptions& options);

}  // namespace colmap_seapoint
