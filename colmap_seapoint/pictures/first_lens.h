// The lens that a new camera begins with, and who says so.
#pragma once

#include <string>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/pictures/image_reader_options.h"

namespace colmap_seapoint {

struct FirstLens {
  Camera camera;       // without an id
  std::string origin;  // "focal length 2759 px from EXIF (35 mm equivalent), seen through ..."
};

// In this order: the parameters that the user gives; the focal length of the user's preset; of EXIF
// (cameras/exif_focal_length.h; before the preset's where that says so); a guess. What a preset and
// EXIF know is for air, and multiplied by what the preset's port makes of it. No distortion, and
// the principal point in the centre, but in the user's parameters. `options` is legal.
FirstLens FirstLensOf(const ImageInfo& picture, const ImageReaderOptions& options);

}  // namespace colmap_seapoint
