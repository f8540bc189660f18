#include "colmap_seapoint/workspace/posed_pictures.h"

#include <algorithm>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/content_hash.h"

namespace colmap_seapoint {

std::vector<std::string> PosedPictureLines(const std::filesystem::path& path,
                                           const PictureMasks& masks) {
  const SparseModel model = ReadSparseModel(path, ModelContent::kPosesAndPoints);
  std::vector<std::string> lines;
  for (const PosedImage& image : model.images) {
    const Camera& camera = model.cameras.at(image.camera_id);
    ContentHash hash;
    const int numbers[] = {static_cast<int>(camera.model), camera.width, camera.height};
    hash.Add(numbers, sizeof(numbers));
    hash.Add(camera.params.data(), camera.params.size() * sizeof(double));
    hash.Add(image.cam_from_world.rotation.coeffs().data(), 4 * sizeof(double));
    hash.Add(image.cam_from_world.translation.data(), 3 * sizeof(double));
    const std::string mask = masks.Fingerprint({image.name});
    hash.Add(mask.data(), mask.size());
    lines.push_back(image.name + " " + hash.Text());
  }
  return lines;
}

bool BeginWith(const std::vector<std::string>& lines, const std::vector<std::string>& first) {
  return first.size() <= lines.size() && std::equal(first.begin(), first.end(), lines.begin());
}

}  // namespace colmap_seapoint
