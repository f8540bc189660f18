#include "densify/sequence/track.h"

#include <algorithm>
#include <utility>

namespace colmap_seapoint {

Track::Track(const SparseModel& model, std::vector<int> order, const StereoRig& rig)
    : model_(model),
      order_(std::move(order)),
      position_of_(order_.size()),
      length_(NumPictures()),
      right_of_(order_.size(), -1) {
  if (!rig.is_right.empty()) {
    const auto track_end = std::stable_partition(order_.begin(), order_.end(), [&](int image_idx) {
      return rig.is_right[static_cast<size_t>(image_idx)] == 0;
    });
    length_ = static_cast<int>(track_end - order_.begin());
  }
  for (int position = 0; position < NumPictures(); ++position) {
    position_of_[static_cast<size_t>(ImageIdx(position))] = position;
  }
  if (rig.is_right.empty()) return;
  for (int position = 0; position < NumPictures(); ++position) {
    const int right = rig.right_of[static_cast<size_t>(ImageIdx(position))];
    if (right >= 0) right_of_[static_cast<size_t>(position)] = PositionOf(right);
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
