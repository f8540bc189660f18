// Cameras that divers use, by name, with the port that they look through (ours).
//
// A lens that EXIF does not know, or knows in air alone, is a bad start: behind a flat port it is a
// third longer. A preset gives the camera model and a focal length to begin with; the pictures
// decide in the end, as without one.
#pragma once

#include <string>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

enum class Port { kFlat, kDome };

// What the focal length in air is multiplied by, under water: the refractive index behind a flat
// port; 1 behind a dome whose centre the lens is in.
double WaterFactor(Port port);
// "a flat port", "a dome".
const char* PortText(Port port);

struct CameraPreset {
  const char* name;
  Port port;
  CameraModel model;   // of the camera and its port together
  double focal;        // in air, in units of the picture's longer side; 0: EXIF alone tells it
  bool believes_exif;  // where EXIF tells a focal length it counts, and `focal` where not
  const char* camera;  // which it is, and where the figure is from
};

// nullptr when there is none of that name.
const CameraPreset* FindCameraPreset(const std::string& name);

// The sentence for the user who has typed a name that is none, with the three nearest.
std::string UnknownPreset(const std::string& name);

// All of them, a line each, for the user.
std::string CameraPresetList();

}  // namespace colmap_seapoint
