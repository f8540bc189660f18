#include "examples/survey/view_gsd.h"

#include <cstdint>
#include <fstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "examples/survey/paths/survey_camera.h"

namespace colmap_seapoint {
namespace {

template <typename T>
T ReadValue(std::ifstream* file, const std::filesystem::path& path) {
  T value{};
  file->read(reinterpret_cast<char*>(&value), sizeof(value));
  if (!*file) throw Error(path.string(), "ends too early", "densify the model again");
  return value;
}

}  // namespace

std::vector<float> ViewGsd(const SparseModel& model, const std::vector<Eigen::Vector3f>& points,
                           const std::filesystem::path& cloud_path) {
  const std::filesystem::path path = cloud_path.string() + ".vis";
  std::ifstream file(path, std::ios::binary);
  if (!file) return {};
  SparseModel sorted;
  sorted.cameras = model.cameras;
  sorted.images = model.images;
  SortImagesById(&sorted);
  if (ReadValue<uint64_t>(&file, path) != points.size()) {
    throw Error(path.string(), "is of another cloud", "densify the model again");
  }
  std::vector<float> gsd(points.size());
  for (size_t k = 0; k < points.size(); ++k) {
    const auto num_views = ReadValue<uint32_t>(&file, path);
    double sum = 0;
    for (uint32_t v = 0; v < num_views; ++v) {
      const auto image_idx = ReadValue<uint32_t>(&file, path);
      if (image_idx >= sorted.images.size()) {
        throw Error(path.string(), "names picture " + std::to_string(image_idx),
                    "give the model that the cloud was made from");
      }
      const PosedImage& image = sorted.images[image_idx];
      sum += GsdAt(sorted.cameras.at(image.camera_id),
                   image.cam_from_world * points[k].cast<double>());
    }
    gsd[k] = num_views > 0 ? static_cast<float>(sum / num_views) : 0;
  }
  return gsd;
}

}  // namespace colmap_seapoint
