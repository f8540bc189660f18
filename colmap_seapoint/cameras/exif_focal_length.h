// The focal length that EXIF tells, in pixels of the picture at hand.
#pragma once

#include <optional>

#include "colmap_seapoint/io/image/exif_camera.h"

namespace colmap_seapoint {

enum class FocalSource { k35mmEquivalent, kFocalPlane, kSensorTable };

// "35 mm equivalent", "resolution of the sensor", "size of the sensor, LensFun".
const char* SourceText(FocalSource source);

struct ExifFocalLength {
  double px = 0;
  FocalSource source = FocalSource::k35mmEquivalent;
};

// The first that is there and can be, in this order: the 35 mm equivalent by COLMAP's rule (35 mm
// are the longer side); the focal length with the resolution of the sensor, unless sensor_table.h
// gives the sensor another size; the focal length with the sensor's size by that table. `width`,
// `height`: of the picture as it is stored. Where it has other proportions than the picture that
// was taken, and fits into it, it was cut out of it at its full resolution; else it was made
// smaller, and turned perhaps: a cut of the same proportions cannot be told from that. In air: see
// camera_presets.h for water. nullopt when EXIF tells none, or one below a tenth or above a hundred
// times of the longer side.
std::optional<ExifFocalLength> FocalLengthFromExif(const ExifCamera& camera, int width, int height);

}  // namespace colmap_seapoint
