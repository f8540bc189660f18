// What is kept of a picture around a point, to find the point again in other pictures.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "colmap_seapoint/base/image.h"
#include "feature/kernels/warp_kernels.h"

namespace colmap_seapoint {

// A patch of 15 x 15 pixels and one pixel around it, for the gradients; 289 bytes.
struct ReferencePatch {
  static constexpr int kReach = warp::kReach + 1;
  static constexpr int kSide = 2 * kReach + 1;
  std::array<uint8_t, static_cast<size_t>(kSide* kSide)> gray;
};

// Whether a patch around pixel (x, y) lies within a picture of this size.
inline bool HoldsPatch(int width, int height, int x, int y) {
  constexpr int kReach = ReferencePatch::kReach;
  return x >= kReach && y >= kReach && x < width - kReach && y < height - kReach;
}

// Around pixel (x, y); nullopt where it does not lie within the picture.
std::optional<ReferencePatch> CutPatch(const GrayImage& picture, int x, int y);

}  // namespace colmap_seapoint
