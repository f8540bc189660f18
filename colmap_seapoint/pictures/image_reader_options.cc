#include "colmap_seapoint/pictures/image_reader_options.h"

#include <locale>
#include <sstream>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

void ImageReaderOptions::Bind(OptionTable* table) {
  table->Add("ImageReader.camera_model", &camera_model,
             "camera model of new cameras: " + CameraModelNames(), "COLMAP (there SIMPLE_RADIAL)");
  table->Add("ImageReader.camera_params", &camera_params,
             "parameters of new cameras, separated by commas, in pixels; empty = focal length from "
             "EXIF or guessed, no distortion",
             "COLMAP");
  table->Add("ImageReader.single_camera", &single_camera, "all pictures share one camera",
             "COLMAP");
  table->Add("ImageReader.single_camera_per_folder", &single_camera_per_folder,
             "pictures of one folder, size and EXIF camera share one camera",
             "COLMAP (there 0, and the folder alone decides)");
  table->Add("ImageReader.default_focal_length_factor", &default_focal_length_factor,
             "guess of the focal length without EXIF, in units of the picture's longer side",
             "COLMAP", 0.1, 100);
  table->Add("ImageReader.mask_path", &mask_path,
             "folder of masks <image name>.png, no SeaPoints where a mask is 0; empty = none",
             "COLMAP");
}

std::string ImageReaderOptions::Check() const {
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
