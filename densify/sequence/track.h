// The order in which pictures are densified: the track of the camera (paper 2.5: successive views
// overlap most), with the simultaneous right pictures of a rig (paper 4) beside it.
#pragma once

#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/base/stereo_rig.h"
#include "densify/match/view.h"

namespace colmap_seapoint {

// Positions count along the track, in the order of OrderPictures; those of a rig's right pictures
// come behind it, in the same order.
class Track {
 public:
  // `model` outlives it; `order` holds every image_idx once. Throws std::out_of_range later when an
  // image's camera is missing.
  Track(const SparseModel& model, std::vector<int> order, const StereoRig& rig);

  int NumPictures() const { return static_cast<int>(order_.size()); }
  int Length() const { return length_; }  // pictures on the track, without right ones
  const std::vector<int>& Order() const { return order_; }  // position -> image_idx
  int ImageIdx(int position) const { return order_[static_cast<size_t>(position)]; }
  int PositionOf(int image_idx) const { return position_of_[static_cast<size_t>(image_idx)]; }
  const PosedImage& Image(int position) const;
  const Camera& CameraOf(int position) const {
    return model_.cameras.at(Image(position).camera_id);
  }
  View ViewOf(int position) const;
  double LongerSide(int position) const;  // pixels
  // Position of the simultaneous right picture, or -1.
  int RightOf(int position) const { return right_of_[static_cast<size_t>(position)]; }
  // Whether another picture follows on the track, or `first` has a simultaneous one.
  bool CanStartPair(int first) const;

 private:
  const SparseModel& model_;
  std::vector<int> order_, position_of_;
  int length_ = 0;
  std::vector<int> right_of_;
};

}  // namespace colmap_seapoint
