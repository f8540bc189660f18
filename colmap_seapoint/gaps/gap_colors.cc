#include "colmap_seapoint/gaps/gap_colors.h"

namespace colmap_seapoint {

std::array<uint8_t, 3> CauseColor(GapCause cause) {
  switch (cause) {
    case GapCause::kNeverImaged:
      return {213, 94, 0};
    case GapCause::kImagedOnce:
      return {230, 159, 0};
    case GapCause::kNoTexture:
      return {240, 228, 66};
    case GapCause::kBadPicture:
      return {204, 121, 167};
    case GapCause::kPoseLost:
      return {0, 114, 178};
    case GapCause::kOccluded:
      return {86, 180, 233};
    case GapCause::kSmallParallax:
      return {255, 255, 255};
    case GapCause::kViewsDisagree:
      return {0, 158, 115};
    default:
      return {40, 40, 40};
  }
}

const char* CauseText(GapCause cause) {
  switch (cause) {
    case GapCause::kNeverImaged:
      return "never imaged";
    case GapCause::kImagedOnce:
      return "imaged once only";
    case GapCause::kNoTexture:
      return "shows nothing that could be matched";
    case GapCause::kBadPicture:
      return "blurred or badly exposed";
    case GapCause::kPoseLost:
      return "its pictures are in no model";
    case GapCause::kOccluded:
      return "hidden but from one side";
    case GapCause::kSmallParallax:
      return "seen from nearly one place only";
    case GapCause::kViewsDisagree:
      return "its pictures disagree";
    default:
      return "";
  }
}

}  // namespace colmap_seapoint
