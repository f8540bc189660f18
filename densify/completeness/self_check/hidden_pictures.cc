#include "densify/completeness/self_check/hidden_pictures.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "colmap_seapoint/base/natural_order.h"

namespace colmap_seapoint {

std::vector<bool> HiddenInFold(const SparseModel& model, int fold) {
  std::vector<size_t> order(model.images.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return NaturalLess(model.images[a].name, model.images[b].name);
  });
  std::vector<bool> is_hidden(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    is_hidden[order[i]] = static_cast<int>(i % kNumFolds) == fold;
  }
  return is_hidden;
}

SparseModel WithoutHidden(const SparseModel& model, const std::vector<bool>& is_hidden) {
  SparseModel rest;
  rest.cameras = model.cameras;
  std::set<uint32_t> hidden_ids;
  for (size_t i = 0; i < model.images.size(); ++i) {
    if (is_hidden[i]) {
      hidden_ids.insert(model.images[i].image_id);
    } else {
      rest.images.push_back(model.images[i]);
    }
  }
  for (const auto& [id, point] : model.points3D) {
    const auto num_left = std::count_if(
        point.track.begin(), point.track.end(),
        [&](const SparsePoint::TrackElement& at) { return hidden_ids.count(at.image_id) == 0; });
    if (num_left >= 2) rest.points3D.emplace_hint(rest.points3D.end(), id, point);
  }
  return rest;
}

CompletenessInput InputWithoutHidden(const CompletenessInput& full, const SparseModel& rest,
                                     const std::vector<bool>& is_hidden) {
  CompletenessInput input;
  input.model = &rest;
  input.num_points = full.num_points;
  input.for_each_point = [&](const auto& take) {
    full.for_each_point([&](const ConfidentPoint& point) {
      const bool is_left = std::none_of(point.pictures.begin(), point.pictures.end(),
                                        [&](uint32_t i) { return is_hidden[i]; });
      if (is_left) take(point);
    });
  };
  input.lost = full.lost;
  for (size_t i = 0; i < is_hidden.size(); ++i) {
    if (is_hidden[i]) {
      input.lost.push_back(full.model->images[i].name);
    } else {
      input.facts.push_back(full.facts[i]);
    }
  }
  input.posed_elsewhere = full.posed_elsewhere;
  input.asked = full.asked;
  return input;
}

}  // namespace colmap_seapoint
