// What a gap looks like in the pictures next to it, so that a diver finds the place again.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

struct GapPicture {
  std::string name;        // of the picture
  bool shows_gap = false;  // the gap's middle lies in it
  ColorImage crop;         // up to kGapPictureSide pixels across
  // Where the gap's outline lies in the crop, pixels; empty where it does not lie in it whole
  // enough to be drawn.
  std::vector<std::vector<Eigen::Vector2d>> outline;
};

inline constexpr int kGapPictureSide = 360;  // pixels
inline constexpr size_t kGapsWithPictures = 30;
inline constexpr size_t kPicturesOfGap = 2;

// By position in result.gaps; empty for all but the first kGapsWithPictures, and where no picture
// can be read. Of the gap's nearest pictures those that show its middle come first. A crop shows
// the gap and as much again around it, at least a third of the picture. `read` (any thread) returns
// an empty picture for one that cannot be used. Every picture is read once.
std::vector<std::vector<GapPicture>> CutGapPictures(
    const CompletenessResult& result, const SparseModel& model,
    const std::function<ColorImage(const std::string& name)>& read, int num_threads);

}  // namespace colmap_seapoint
