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
  std::string camera_preset;                 // cameras/camera_presets.h; empty = none
  bool single_camera = false;                // all pictures share one
  int single_camera_per_folder = -1;         // those of one folder, size and EXIF camera do;
                                             // -1: those of a camera that went on to another
                                             // folder too (cameras/camera_identity.h)
  double default_focal_length_factor = 1.2;  // guess, in units of the picture's longer side
  std::string mask_path;                     // folder of <image name>.png; empty = none

  void Bind(OptionTable* table);
  // The camera model that follows from the preset.
  void Preset();
  // "" or the whole sentence.
  std::string Check() const;
  // The numbers of camera_params; nullopt when a part is no finite number.
  std::optional<std::vector<double>> CameraParams() const;
};

}  // namespace colmap_seapoint
