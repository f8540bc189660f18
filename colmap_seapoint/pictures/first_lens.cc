#include "colmap_seapoint/pictures/first_lens.h"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/cameras/camera_presets.h"
#include "colmap_seapoint/cameras/exif_focal_length.h"

namespace colmap_seapoint {
namespace {

struct Focal {
  double px = 0;
  std::string origin;  // "from EXIF (35 mm equivalent)"
};

std::string Formatted(const char* format, double value) {
  char text[60];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::optional<Focal> FromExif(const ImageInfo& picture) {
  const auto focal = FocalLengthFromExif(picture.camera, picture.width, picture.height);
  if (!focal) return std::nullopt;
  return Focal{focal->px, std::string("from EXIF (") + SourceText(focal->source) + ")"};
}

std::optional<Focal> FromPreset(const CameraPreset& preset, const ImageInfo& picture) {
  if (preset.focal <= 0) return std::nullopt;
  return Focal{preset.focal * std::max(picture.width, picture.height),
               std::string("of the preset ") + preset.name};
}

Focal Guess(const ImageInfo& picture, double factor) {
  return {factor * std::max(picture.width, picture.height),
          "guessed (" + Formatted("%g", factor) + " x the longer side)"};
}

// What is known of the lens, in air; nullopt when nothing is.
std::optional<Focal> KnownFocal(const ImageInfo& picture, const CameraPreset* preset) {
  const std::optional<Focal> exif = FromExif(picture);
  if (preset == nullptr || (exif && preset->believes_exif)) return exif;
  return FromPreset(*preset, picture);
}

std::optional<Focal> UnderWater(std::optional<Focal> focal, const CameraPreset* preset) {
  if (!focal || preset == nullptr) return focal;
  const double factor = WaterFactor(preset->port);
  focal->px *= factor;
  focal->origin += std::string(", seen through ") + PortText(preset->port);
  if (factor != 1) focal->origin += Formatted(" x %.2f", factor);
  return focal;
}

}  // namespace

FirstLens FirstLensOf(const ImageInfo& picture, const ImageReaderOptions& options) {
  const CameraModelInfo* model = FindCameraModel(options.camera_model);
  SEAPOINT_CHECK(model != nullptr);
  const CameraPreset* preset = FindCameraPreset(options.camera_preset);
  const std::optional<Focal> known = UnderWater(KnownFocal(picture, preset), preset);
  const Focal focal = known.value_or(Guess(picture, options.default_focal_length_factor));
  FirstLens lens;
  lens.camera = MakeCamera(model->model, focal.px, picture.width, picture.height);
  lens.camera.has_prior_focal_length = known.has_value();
  lens.origin = "focal length " + Formatted("%.0f", focal.px) + " px " + focal.origin;
  if (options.camera_params.empty()) return lens;
  lens.camera.params = *options.CameraParams();
  lens.camera.has_prior_focal_length = true;
  lens.origin = "focal length " + Formatted("%.0f", lens.camera.MeanFocal()) +
                " px, as all of the lens from --ImageReader.camera_params";
  return lens;
}

}  // namespace colmap_seapoint
