#include "colmap_seapoint/pictures/picture_scale.h"

#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

struct PictureSize {
  int width, height;
};

// nullopt for pictures that cannot be read: whoever needs them says why.
std::optional<PictureSize> SizeOf(const std::filesystem::path& path) {
  try {
    const ImageInfo info = ReadImageInfo(path);
    return PictureSize{info.width, info.height};
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

int ScaleCamerasToPictures(const std::filesystem::path& image_path, int num_threads,
                           SparseModel* model) {
  std::vector<std::optional<PictureSize>> sizes(model->images.size());
  ParallelFor(num_threads, static_cast<int64_t>(sizes.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    sizes[i] = SizeOf(image_path / model->images[i].name);
  });
  int num_scaled = 0;
  std::map<std::tuple<uint32_t, int, int>, uint32_t> scaled_ids;  // by old id and size
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (!sizes[i]) continue;
    PosedImage& image = model->images[i];
    const Camera& camera = model->cameras.at(image.camera_id);
    const auto [width, height] = *sizes[i];
    if ((width == camera.width && height == camera.height) ||
        !AreScaledSizes(camera.width, camera.height, width, height)) {
      continue;
    }
    const Eigen::Vector2d scale(static_cast<double>(width) / camera.width,
                                static_cast<double>(height) / camera.height);
    for (Eigen::Vector2d& point : image.points2D) point = point.cwiseProduct(scale);
    const auto [known, is_new] = scaled_ids.try_emplace({image.camera_id, width, height},
                                                        model->cameras.rbegin()->first + 1);
    if (is_new) {
      Camera scaled = ScaledCamera(camera, width, height);
      scaled.camera_id = known->second;
      model->cameras.emplace(scaled.camera_id, std::move(scaled));
    }
    image.camera_id = known->second;
    ++num_scaled;
  }
  return num_scaled;
}

}  // namespace colmap_seapoint
