#include "densify/sequence/track.h"

#include <algorithm>
#include <numeric>

#include "colmap_seapoint/base/natural_order.h"

namespace colmap_seapoint {

namespace {

std::vector<int> OrderByName(const SparseModel& model) {
  std::vector<int> order(model.images.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return NaturalLess(model.images[static_cast<size_t>(a)].name,
                       model.images[static_cast<size_t>(b)].name);
  });
  return order;
}

}  // namespace

Track::Track(const SparseModel& model, const StereoRig& rig)
    : model_(model),
      order_(OrderByName(model)),
      length_(NumPictures()),
      right_of_(order_.size(), -1) {
  if (rig.is_right.empty()) return;
  const auto track_end = std::stable_partition(order_.begin(), order_.end(), [&](int image_idx) {
    return rig.is_right[static_cast<size_t>(image_idx)] == 0;
  });
  length_ = static_cast<int>(track_end - order_.begin());
  std::vector<int> position_of(order_.size());
  for (int position = 0; position < NumPictures(); ++position) {
    position_of[static_cast<size_t>(ImageIdx(position))] = position;
  }
  for (int position = 0; position < NumPictures(); ++position) {
    const int right = rig.right_of[static_cast<size_t>(ImageIdx(position))];
    if (right >= 0) {
      right_of_[static_cast<size_t>(position)] = position_of[static_cast<size_t>(right)];
    }
  }
}

const PosedImage& Track::Image(int position) const {
  return model_.images[static_cast<size_t>(ImageIdx(position))];
}

View Track::ViewOf(int position) const {
  return {ImageIdx(position), CameraOf(position), Image(position).cam_from_world};
}

double Track::LongerSide(int position) const {
  const Camera& camera = CameraOf(position);
  return std::max(camera.width, camera.height);
}

bool Track::CanStartPair(int first) const {
  return first + 1 < length_ || (first < length_ && RightOf(first) >= 0);
}

}  // namespace colmap_seapoint
