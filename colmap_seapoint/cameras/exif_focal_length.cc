#include "colmap_seapoint/cameras/exif_focal_length.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/cameras/sensor_table.h"

namespace colmap_seapoint {
namespace {

constexpr double kSameProportions = 0.02;
// Longer sides, from a phone's second camera to medium format.
constexpr double kMinSensorMm = 2.5, kMaxSensorMm = 100;
// Programs that make pictures smaller write their new size into EXIF, but seldom the resolution:
// the sensor then comes out too small.
constexpr double kMaxSensorError = 0.15;
// Of the focal length, in units of the longer side.
constexpr double kMinFocal = 0.1, kMaxFocal = 100;

struct Sides {
  double longer = 0, shorter = 0;
};

Sides SidesOf(double a, double b) { return {std::max(a, b), std::min(a, b)}; }

// The longer side, in pixels of the picture at hand, of what the sensor took, and its proportions.
struct Frame {
  double longer_px = 0;
  double proportions = 1;  // longer to shorter side
  double scale = 1;        // pixels of the picture at hand a pixel of the sensor; 0: not known
};

Frame FrameOf(const ExifCamera& camera, int width, int height) {
  const Sides picture = SidesOf(width, height);
  const Frame whole = {picture.longer, picture.longer / picture.shorter, 0};
  if (camera.taken_width <= 0) return whole;
  // Some cameras tell the width alone.
  const double taken_height =
      camera.taken_height > 0 ? camera.taken_height : camera.taken_width * height / width;
  const Sides taken = SidesOf(camera.taken_width, taken_height);
  const double proportions = taken.longer / taken.shorter;
  if (std::abs(proportions / whole.proportions - 1) <= kSameProportions) {
    return {picture.longer, whole.proportions, picture.longer / taken.longer};
  }
  const bool fits = picture.longer <= taken.longer && picture.shorter <= taken.shorter;
  return fits ? Frame{taken.longer, proportions, 1} : whole;
}

double By35mm(const ExifCamera& camera, const Frame& frame) {
  return camera.focal_35mm / 35.0 * frame.longer_px;
}

// The longer side of the sensor by its table; 0 where that does not hold it. Pictures of other
// proportions than the sensor's are as long, or as high, as it.
double TabledLongerMm(const ExifCamera& camera, const Frame& frame) {
  const auto sensor = FindSensor(camera.maker, camera.model);
  if (!sensor) return 0;
  const double proportions = sensor->is_four_thirds ? 4.0 / 3.0 : 1.5;
  const double shorter_mm = sensor->diagonal_mm / std::hypot(proportions, 1.0);
  return shorter_mm * std::min(proportions, frame.proportions);
}

double ByFocalPlane(const ExifCamera& camera, const Frame& frame) {
  if (camera.pixels_per_mm <= 0 || frame.scale <= 0) return 0;
  const double longer_mm = frame.longer_px / frame.scale / camera.pixels_per_mm;
  if (longer_mm < kMinSensorMm || longer_mm > kMaxSensorMm) return 0;
  const double tabled_mm = TabledLongerMm(camera, frame);
  if (tabled_mm > 0 && std::abs(longer_mm / tabled_mm - 1) > kMaxSensorError) return 0;
  return camera.focal_mm / longer_mm * frame.longer_px;
}

double BySensor(const ExifCamera& camera, const Frame& frame) {
  const double longer_mm = TabledLongerMm(camera, frame);
  return longer_mm > 0 ? camera.focal_mm / longer_mm * frame.longer_px : 0;
}

}  // namespace

const char* SourceText(FocalSource source) {
  switch (source) {
    case FocalSource::k35mmEquivalent:
      return "35 mm equivalent";
    case FocalSource::kFocalPlane:
      return "resolution of the sensor";
    case FocalSource::kSensorTable:
      return "size of the sensor, LensFun";
  }
  SEAPOINT_CHECK(false);
  return "";
}

std::optional<ExifFocalLength> FocalLengthFromExif(const ExifCamera& camera, int width,
                                                   int height) {
  const Frame frame = FrameOf(camera, width, height);
  const double longer = std::max(width, height);
  using Rule = double (*)(const ExifCamera&, const Frame&);
  const std::pair<FocalSource, Rule> rules[] = {{FocalSource::k35mmEquivalent, By35mm},
                                                {FocalSource::kFocalPlane, ByFocalPlane},
                                                {FocalSource::kSensorTable, BySensor}};
  for (const auto& [source, rule] : rules) {
    const double px = rule(camera, frame);
    if (px >= kMinFocal * longer && px <= kMaxFocal * longer) return ExifFocalLength{px, source};
  }
  return std::nullopt;
}

}  // namespace colmap_seapoint
