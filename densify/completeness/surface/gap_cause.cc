#include "densify/completeness/surface/gap_cause.h"

namespace colmap_seapoint {

const char* GapCauseName(GapCause cause) {
  switch (cause) {
    case GapCause::kNone:
      return "none";
    case GapCause::kNeverImaged:
      return "never_imaged";
    case GapCause::kImagedOnce:
      return "imaged_once";
    case GapCause::kNoTexture:
      return "no_texture";
    case GapCause::kBadPicture:
      return "bad_picture";
    case GapCause::kPoseLost:
      return "pose_lost";
    case GapCause::kOccluded:
      return "occluded";
    case GapCause::kSmallParallax:
      return "small_parallax";
    case GapCause::kViewsDisagree:
      return "views_disagree";
    case GapCause::kOutOfArea:
      return "out_of_area";
  }
  return "none";
}

}  // namespace colmap_seapoint
