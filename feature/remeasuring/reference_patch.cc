#include "feature/remeasuring/reference_patch.h"

#include <algorithm>

namespace colmap_seapoint {

std::optional<ReferencePatch> CutPatch(const GrayImage& picture, int x, int y) {
  constexpr int kReach = ReferencePatch::kReach, kSide = ReferencePatch::kSide;
  if (!HoldsPatch(picture.width, picture.height, x, y)) return std::nullopt;
  ReferencePatch patch;
  for (int j = 0; j < kSide; ++j) {
    const uint8_t* row = picture.Row(y - kReach + j) + x - kReach;
    std::copy_n(row, kSide, patch.gray.data() + j * kSide);
  }
  return patch;
}

}  // namespace colmap_seapoint
