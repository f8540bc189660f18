#include "colmap_seapoint/joining/model_links.h"

#include <algorithm>
#include <map>
#include <optional>

namespace colmap_seapoint {
namespace {

using ImageIndices = std::map<uint32_t, uint32_t>;  // by image_id

ImageIndices IndicesOf(const SparseModel& model) {
  ImageIndices indices;
  for (uint32_t i = 0; i < model.images.size(); ++i) indices[model.images[i].image_id] = i;
  return indices;
}

std::optional<uint64_t> PointOf(const SparseModel& model, uint32_t image_idx, uint32_t feature) {
  const std::vector<uint64_t>& ids = model.images[image_idx].point3D_ids;
  if (feature >= ids.size() || model.points3D.count(ids[feature]) == 0) return std::nullopt;
  return ids[feature];
}

void AddLinks(const SparseModel& a, uint32_t image_idx_a, const SparseModel& b,
              uint32_t image_idx_b, const FeatureMatches& matches, std::vector<ModelLink>* links) {
  for (const FeatureMatch& match : matches) {
    const auto point_a = PointOf(a, image_idx_a, match.idx1);
    const auto point_b = PointOf(b, image_idx_b, match.idx2);
    if (!point_a || !point_b) continue;
    links->push_back({*point_a, *point_b, image_idx_a, image_idx_b,
                      a.images[image_idx_a].points2D[match.idx1],
                      b.images[image_idx_b].points2D[match.idx2]});
  }
}

void AddSharedPictures(const SparseModel& a, const SparseModel& b, const ImageIndices& indices_b,
                       std::vector<ModelLink>* links) {
  for (uint32_t i = 0; i < a.images.size(); ++i) {
    const auto shared = indices_b.find(a.images[i].image_id);
    if (shared == indices_b.end()) continue;
    FeatureMatches same;
    for (uint32_t k = 0; k < a.images[i].points2D.size(); ++k) same.push_back({k, k});
    AddLinks(a, i, b, shared->second, same, links);
  }
}

FeatureMatches Swapped(FeatureMatches matches) {
  for (FeatureMatch& match : matches) std::swap(match.idx1, match.idx2);
  return matches;
}

}  // namespace

ModelLinks FindModelLinks(const ColmapDatabase& database, const SparseModel& a,
                          const SparseModel& b) {
  const ImageIndices indices_a = IndicesOf(a), indices_b = IndicesOf(b);
  ModelLinks result;
  AddSharedPictures(a, b, indices_b, &result.links);
  const auto add = [&](uint32_t id_a, uint32_t id_b, const FeatureMatches& inliers) {
    // Pictures of both models are linked already, and say nothing of what was not matched.
    if (indices_b.count(id_a) > 0 || indices_a.count(id_b) > 0) return;
    const auto in_a = indices_a.find(id_a), in_b = indices_b.find(id_b);
    if (in_a == indices_a.end() || in_b == indices_b.end()) return;
    result.tried.insert({id_a, id_b});
    AddLinks(a, in_a->second, b, in_b->second, inliers, &result.links);
  };
  for (const auto& [id1, id2] : ReadTriedPairs(database)) {
    const bool is_forward = indices_a.count(id1) > 0 && indices_b.count(id2) > 0;
    const bool is_backward = indices_a.count(id2) > 0 && indices_b.count(id1) > 0;
    if (!is_forward && !is_backward) continue;
    const FeatureMatches inliers = ReadTwoViewGeometry(database, {id1, id2}).inliers;
    if (is_forward) add(id1, id2, inliers);
    if (is_backward) add(id2, id1, Swapped(inliers));
  }
  return result;
}

}  // namespace colmap_seapoint
