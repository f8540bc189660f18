#include "colmap_seapoint/lens/compact_part.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace colmap_seapoint {
namespace {

// Chooses the pictures: how many points each shares with those that are chosen.
class Choice {
 public:
  explicit Choice(const SparseModel& model)
      : model_(model), is_chosen_(model.images.size(), 0), num_shared_(model.images.size(), 0) {
    for (size_t i = 0; i < model.images.size(); ++i) idx_of_id_[model.images[i].image_id] = i;
  }

  // The first of those that share most with the chosen ones; of none, the one that observes most.
  size_t Next() const {
    size_t best = model_.images.size();
    for (size_t i = 0; i < model_.images.size(); ++i) {
      if (is_chosen_[i]) continue;
      if (best == model_.images.size() || Value(i) > Value(best)) best = i;
    }
    return best;
  }

  void Take(size_t idx) {
    is_chosen_[idx] = 1;
    is_begun_ = true;
    for (const uint64_t id : model_.images[idx].point3D_ids) {
      const auto point = model_.points3D.find(id);
      if (point == model_.points3D.end() || !seen_.insert(id).second) continue;
      for (const auto& element : point->second.track) {
        const auto image = idx_of_id_.find(element.image_id);
        if (image != idx_of_id_.end()) ++num_shared_[image->second];
      }
    }
  }

  bool Has(uint32_t image_id) const {
    const auto idx = idx_of_id_.find(image_id);
    return idx != idx_of_id_.end() && is_chosen_[idx->second];
  }

 private:
  size_t Value(size_t idx) const {
    if (is_begun_) return num_shared_[idx];
    const auto& ids = model_.images[idx].point3D_ids;
    return ids.size() - static_cast<size_t>(std::count(ids.begin(), ids.end(), kNoPoint3D));
  }

  const SparseModel& model_;
  std::unordered_map<uint32_t, size_t> idx_of_id_;
  std::vector<uint8_t> is_chosen_;
  std::vector<size_t> num_shared_;
  std::unordered_set<uint64_t> seen_;  // points of the chosen pictures
  bool is_begun_ = false;
};

}  // namespace

SparseModel CompactPart(const SparseModel& model, size_t max_pictures) {
  if (model.images.size() <= max_pictures) return model;
  Choice choice(model);
  for (size_t k = 0; k < max_pictures; ++k) choice.Take(choice.Next());
  SparseModel part;
  part.cameras = model.cameras;
  for (const auto& [id, point] : model.points3D) {
    SparsePoint kept = point;
    kept.track.erase(std::remove_if(kept.track.begin(), kept.track.end(),
                                    [&](const auto& e) { return !choice.Has(e.image_id); }),
                     kept.track.end());
    if (kept.track.size() >= 2) part.points3D.emplace(id, std::move(kept));
  }
  for (const PosedImage& image : model.images) {
    if (!choice.Has(image.image_id)) continue;
    part.images.push_back(image);
    for (uint64_t& id : part.images.back().point3D_ids) {
      if (part.points3D.count(id) == 0) id = kNoPoint3D;
    }
  }
  return part;
}

}  // namespace colmap_seapoint
