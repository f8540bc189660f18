#include "colmap_seapoint/joining/merge_models.h"

#include <algorithm>
#include <map>
#include <utility>

#include "colmap_seapoint/io/colmap/colmap_model.h"

namespace colmap_seapoint {
namespace {

using Observations = std::map<uint32_t, uint32_t>;  // image_id -> feature

Observations ObservationsOf(const SparsePoint& point) {
  Observations observations;
  for (const auto& element : point.track) observations[element.image_id] = element.point2D_idx;
  return observations;
}

// The id in `b` of a point of `a` that the links join to it, each point of either once: the first
// link counts.
std::map<uint64_t, uint64_t> JoinedPoints(const std::vector<ModelLink>& links,
                                          const LinkConsensus& consensus) {
  std::map<uint64_t, uint64_t> joined;
  std::set<uint64_t> taken;
  for (const size_t i : consensus.inliers) {
    if (joined.count(links[i].point_a) > 0 || taken.count(links[i].point_b) > 0) continue;
    joined[links[i].point_a] = links[i].point_b;
    taken.insert(links[i].point_b);
  }
  return joined;
}

// Adds a point of `a` to the model, to `target` where that is a point of it; its observations in
// pictures of `b` are those of shared pictures, and b's own count there. False: nothing was added.
bool AddObservations(const SparsePoint& point, const std::set<uint32_t>& pictures_of_b,
                     SparsePoint* target) {
  const Observations known = ObservationsOf(*target);
  bool added = false;
  for (const auto& element : point.track) {
    if (pictures_of_b.count(element.image_id) > 0 || known.count(element.image_id) > 0) continue;
    target->track.push_back(element);
    added = true;
  }
  return added;
}

// Sets which point each feature shows from the tracks, which are the truth here.
void SetPointIds(SparseModel* model) {
  std::map<uint32_t, PosedImage*> images;
  for (PosedImage& image : model->images) {
    std::fill(image.point3D_ids.begin(), image.point3D_ids.end(), kNoPoint3D);
    images[image.image_id] = &image;
  }
  for (const auto& [id, point] : model->points3D) {
    for (const auto& element : point.track) {
      images.at(element.image_id)->point3D_ids.at(element.point2D_idx) = id;
    }
  }
}

}  // namespace

MergedModel MergeModels(const SparseModel& a, const SparseModel& b,
                        const std::vector<ModelLink>& links, const LinkConsensus& consensus) {
  MergedModel merged;
  SparseModel& model = merged.model;
  model = b;
  std::set<uint32_t> pictures_of_b;
  for (const PosedImage& image : b.images) pictures_of_b.insert(image.image_id);
  model.cameras.insert(a.cameras.begin(), a.cameras.end());
  for (const PosedImage& image : a.images) {
    if (pictures_of_b.count(image.image_id) > 0) continue;
    model.images.push_back(image);
    PosedImage& added = model.images.back();
    added.cam_from_world = TransformedPose(image.cam_from_world, consensus.b_from_a);
  }
  const std::map<uint64_t, uint64_t> joined = JoinedPoints(links, consensus);
  uint64_t next_id = b.points3D.empty() ? 1 : b.points3D.rbegin()->first + 1;
  for (const auto& [id, point] : a.points3D) {
    const auto target = joined.find(id);
    if (target != joined.end()) {
      SparsePoint& both = model.points3D.at(target->second);
      if (AddObservations(point, pictures_of_b, &both)) merged.links.insert(target->second);
      continue;
    }
    SparsePoint alone = point;
    alone.track.clear();
    alone.xyz = consensus.b_from_a * point.xyz;
    if (!AddObservations(point, pictures_of_b, &alone) || alone.track.size() < 2) continue;
    model.points3D[next_id++] = std::move(alone);
  }
  SetPointIds(&model);
  SortImagesById(&model);
  return merged;
}

}  // namespace colmap_seapoint
