#include "colmap_seapoint/mapping/add_pictures.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/mapping/continued_part.h"
#include "colmap_seapoint/mapping/measure_again.h"
#include "colmap_seapoint/mapping/sound_adjustment.h"
#include "colmap_seapoint/remeasuring/extend_tracks.h"

namespace colmap_seapoint {
namespace {

// Whether all pictures of `part` are there under their names, and no other lens than the whole has.
bool IsGrownFrom(const SparseModel& part, const SparseModel& whole, const SparseModel& grown) {
  std::map<uint32_t, std::string> names;
  for (const PosedImage& image : grown.images) names[image.image_id] = image.name;
  for (const PosedImage& image : part.images) {
    const auto found = names.find(image.image_id);
    if (found == names.end() || found->second != image.name) return false;
  }
  return std::all_of(grown.images.begin(), grown.images.end(), [&](const PosedImage& image) {
    return whole.cameras.count(image.camera_id) > 0;
  });
}

// The pictures of `added`, those that see a point of theirs, and these points alone.
SparseModel PartAround(const SparseModel& model, const ImageIds& added) {
  SparseModel part;
  part.cameras = model.cameras;
  ImageIds seeing = added;
  for (const auto& [id, point] : model.points3D) {
    bool is_new = false;
    for (const auto& element : point.track) is_new |= added.count(element.image_id) > 0;
    if (!is_new) continue;
    part.points3D[id] = point;
    for (const auto& element : point.track) seeing.insert(element.image_id);
  }
  for (const PosedImage& image : model.images) {
    if (seeing.count(image.image_id) == 0) continue;
    part.images.push_back(image);
    for (uint64_t& id : part.images.back().point3D_ids) {
      if (part.points3D.count(id) == 0) id = kNoPoint3D;
    }
  }
  return part;
}

// The part in place of what it was made of. `were`: its points' ids.
void PutBack(const SparseModel& part, const std::set<uint64_t>& were, const ImageIds& added,
             SparseModel* model) {
  std::map<uint32_t, const PosedImage*> images;
  for (const PosedImage& image : part.images) images[image.image_id] = &image;
  for (PosedImage& image : model->images) {
    const auto found = images.find(image.image_id);
    if (found == images.end()) continue;
    const PosedImage& is = *found->second;
    if (added.count(image.image_id) > 0) image.cam_from_world = is.cam_from_world;
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      if (were.count(image.point3D_ids[k]) == 0) continue;
      image.points2D[k] = is.points2D[k];
      image.point3D_ids[k] = is.point3D_ids[k];
    }
  }
  for (const uint64_t id : were) model->points3D.erase(id);
  model->points3D.insert(part.points3D.begin(), part.points3D.end());
}

// "" or why they stay as the mapper left them.
std::string MeasureAndAdjust(const AdjustmentJob& job, const ImageIds& held, const ImageIds& added,
                             SparseModel* model) {
  SparseModel part = PartAround(*model, added);
  std::set<uint64_t> were;
  for (const auto& [id, point] : part.points3D) were.insert(id);
  const std::map<uint32_t, size_t> num_points2D = NumPoints2D(part);
  ExtendAndMeasure({job.image_path, job.mask_path, job.num_threads}, num_points2D, &part);
  LensLimits limits;
  limits.holds_lens = limits.rejects_outliers = true;
  limits.held_images = held;
  limits.num_threads = job.num_threads;
  SoundAdjustment adjusted = AdjustSoundly(part, limits);
  if (!adjusted.fault.empty()) return adjusted.fault;
  DropExtensions(num_points2D, &adjusted.adjustment.model);
  PutBack(adjusted.adjustment.model, were, added, model);
  return "";
}

}  // namespace

AddedPictures AdjustAddedPictures(const AdjustmentJob& job, const std::filesystem::path& before,
                                  const SparseModel& part, const std::filesystem::path& folder) {
  SparseModel model = ReadSparseModel(before);
  const ImageIds held = IdsOf(model);
  const SparseModel grown = ReadSparseModel(folder);
  if (!IsGrownFrom(part, model, grown)) return {};
  PutPartBack(part, grown, &model);
  ImageIds added = IdsOf(model);
  for (const uint32_t id : held) added.erase(id);
  AddedPictures result;
  result.outcome = std::to_string(added.size()) + " pictures added to the " +
                   std::to_string(held.size()) + " that were there, which stay as they are";
  if (!added.empty()) {
    const std::string fault = MeasureAndAdjust(job, held, added, &model);
    if (!fault.empty()) result.outcome += "; the new ones as the mapper left them: " + fault;
  }
  SortImagesById(&model);
  WriteSparseModelBinary(folder, model);
  result.model = std::move(model);
  return result;
}

}  // namespace colmap_seapoint
