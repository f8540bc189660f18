#include "colmap_seapoint/pictures/image_reader_options.h"

#include <locale>
#include <sstream>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/cameras/camera_presets.h"

namespace colmap_seapoint {

void ImageReaderOptions::Bind(OptionTable* table) {
  table->Add(kCameraPresetOption, &camera_preset,
             "a camera and its port by name, for camera model and focal length to begin with; "
             "'list' shows all; empty = focal length from EXIF, as in air",
             "ours");
  table->SetListing(kCameraPresetOption, CameraPresetList());
  table->Add("ImageReader.camera_model", &camera_model,
             "camera model of new cameras: " + CameraModelNames(), "COLMAP (there SIMPLE_RADIAL)");
  table->Add(
      "ImageReader.camera_params", &camera_params,
      "parameters of new cameras, separated by commas, in pixels, which automatic_reconstructor "
      "then holds unless --Mapper.ba_refine_* is given; empty = focal length from EXIF or "
      "guessed, no distortion",
      "COLMAP");
  table->Add("ImageReader.single_camera", &single_camera, "all pictures share one camera",
             "COLMAP");
  table->Add("ImageReader.single_camera_per_folder", &single_camera_per_folder,
             "1: pictures of one folder, size and EXIF camera share one camera; 0: each has its "
             "own; -1: as 1, and a camera is known again in other folders, by its serial number or "
             "where 101GOPRO follows 100GOPRO",
             "COLMAP (there 0, and the folder alone decides)", -1, 1);
  table->Add("ImageReader.default_focal_length_factor", &default_focal_length_factor,
             "guess of the focal length without EXIF, in units of the picture's longer side",
             "COLMAP", 0.1, 100);
  table->Add("ImageReader.mask_path", &mask_path,
             "folder of masks <image name>.png, no SeaPoints where a mask is 0; empty = none",
             "COLMAP");
}

void ImageReaderOptions::Preset() {
  const CameraPreset* preset = FindCameraPreset(camera_preset);
  if (preset != nullptr) camera_model = FindCameraModel(static_cast<int>(preset->model))->name;
}

std::string ImageReaderOptions::Check() const {
  if (!camera_preset.empty() && FindCameraPreset(camera_preset) == nullptr) {
    return UnknownPreset(camera_preset);
  }
  if (!camera_preset.empty() && !camera_params.empty()) {
    return "--camera_preset " + camera_preset +
           ": cannot be given together with --ImageReader.camera_params, which say it all";
  }
  const CameraModelInfo* model = FindCameraModel(camera_model);
  if (model == nullptr) {
    return "--ImageReader.camera_model " + camera_model + ": must be one of " + CameraModelNames();
  }
  if (camera_params.empty()) return "";
  const auto params = CameraParams();
  if (params && static_cast<int>(params->size()) == model->num_params) return "";
  return "--ImageReader.camera_params " + camera_params + ": must be " +
         std::to_string(model->num_params) + " numbers separated by commas for " + camera_model;
}

std::optional<std::vector<double>> ImageReaderOptions::CameraParams() const {
  std::vector<double> params;
  std::istringstream parts(camera_params);
  for (std::string part; std::getline(parts, part, ',');) {
    std::istringstream number(part);
    number.imbue(std::locale::classic());
    double value = 0;
    if (!(number >> value) || !(number >> std::ws).eof()) return std::nullopt;
    params.push_back(value);
  }
  return params;
}

}  // namespace colmap_seapoint
