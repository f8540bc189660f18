// Which camera took a picture, where nothing but the picture tells: COLMAP's ImageReader options.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// The defaults that differ from COLMAP's are named in the .cc file, where each field is bound to
// its option.
struct ImageReaderOptions {
  std::string camera_model = "OPENCV";       // of new cameras
  std::string camera_params;                 // "fx,fy,cx,cy,..." of new cameras, pixels; empty =
                                             // focal length from EXIF or guessed, no distortion
  bool single_camera = false;                // all pictures share one
  bool single_camera_per_folder = true;      // those of one folder, size and EXIF camera do
  double default_focal_length_factor = 1.2;  // guess, in units of the picture's longer side
  std::string mask_path;                     // folder of <image name>.png; empty = none

  void Bind(OptionTable* table);
  // "" or the whole sentence.
  std::string Check() const;
  // The numbers of camera_params; nullopt when a part is no finite number.
  std::optional<std::vector<double>> CameraParams() const;
};

}  // namespace colmap_seapoint
