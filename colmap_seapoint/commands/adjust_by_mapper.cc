#include "colmap_seapoint/commands/adjust_by_mapper.h"

#include <algorithm>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "colmap_seapoint/io/atomic_file.h"
#include "colmap_seapoint/io/colmap_model.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

size_t NumPointsSeen(const PosedImage& image) {
  return image.point3D_ids.size() -
         static_cast<size_t>(
             std::count(image.point3D_ids.begin(), image.point3D_ids.end(), kNoPoint3D));
}

// The picture that the mapper will find again most surely.
uint32_t MostSeeing(const SparseModel& model) {
  const auto most = std::max_element(
      model.images.begin(), model.images.end(),
      [](const auto& a, const auto& b) { return NumPointsSeen(a) < NumPointsSeen(b); });
  return most->image_id;
}

SparseModel WithoutPicture(SparseModel model, uint32_t image_id) {
  std::set<uint64_t> lost;  // points that one picture alone would see
  for (auto& [id, point] : model.points3D) {
    auto& track = point.track;
    const auto is_gone = [&](const auto& element) { return element.image_id == image_id; };
    track.erase(std::remove_if(track.begin(), track.end(), is_gone), track.end());
    if (track.size() < 2) lost.insert(id);
  }
  for (uint64_t id : lost) model.points3D.erase(id);
  const auto is_gone = [&](const PosedImage& image) { return image.image_id == image_id; };
  model.images.erase(std::remove_if(model.images.begin(), model.images.end(), is_gone),
                     model.images.end());
  for (PosedImage& image : model.images) {
    for (uint64_t& id : image.point3D_ids) {
      if (lost.count(id) > 0) id = kNoPoint3D;
    }
  }
  return model;
}

}  // namespace

SubprocessResult AdjustByMapper(const ColmapProgram& colmap, const SparseModel& model,
                                const MapperAdjustment& adjustment) {
  const fs::path reduced = adjustment.output_path.string() + ".reduced";
  std::error_code error;
  fs::remove_all(reduced, error);
  WriteSparseModelBinary(reduced, WithoutPicture(model, MostSeeing(model)));
  // Else the mapper would go on to pictures that are not the model's.
  std::string names;
  for (const PosedImage& image : model.images) names += image.name + "\n";
  const fs::path list = reduced / "pictures.txt";
  WriteTextFile(list, names);
  std::vector<std::string> arguments = {"mapper",
                                        "--database_path",
                                        adjustment.database_path.string(),
                                        "--image_path",
                                        adjustment.image_path.string(),
                                        "--image_list_path",
                                        list.string(),
                                        "--input_path",
                                        reduced.string(),
                                        "--output_path",
                                        adjustment.output_path.string()};
  AppendOptions(adjustment.options, &arguments);
  const auto result = RunSubprocess(colmap.path, arguments, adjustment.log_path, {});
  fs::remove_all(reduced, error);
  return result;
}

}  // namespace colmap_seapoint
