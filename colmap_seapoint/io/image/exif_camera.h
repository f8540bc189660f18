// What EXIF tells of the camera that took a picture, as it stands there.
#pragma once

#include <string>

namespace colmap_seapoint {

// "" and 0: EXIF does not tell, or tells what cannot be. All numbers are finite and not negative.
struct ExifCamera {
  std::string maker, model;
  std::string lens;    // its model
  std::string serial;  // the body's
  double focal_mm = 0;
  double focal_35mm = 0;     // the 35 mm equivalent, as EXIF has it
  double digital_zoom = 0;   // 1 and 0: none
  double pixels_per_mm = 0;  // on the sensor, of the picture as it was taken
  double taken_width = 0;    // pixels, of the picture as it was taken
  double taken_height = 0;
};

}  // namespace colmap_seapoint
