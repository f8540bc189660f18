// Pictures of one place brought to one brightness and colour (ours).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"
#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"

namespace colmap_seapoint {

// What the light of a picture is multiplied with: a gain a picture and channel, and what lamp and
// lens take away towards the borders, the same in all pictures of one camera.
class Exposure {
 public:
  static constexpr int kNodesX = 7, kNodesY = 5;  // of the falloff, over the picture
  static constexpr int kNumNodes = kNodesX * kNodesY;

  Exposure(std::vector<Light> gains, std::vector<int> falloff_of,
           std::vector<std::array<Light, kNumNodes>> falloffs)
      : gains_(std::move(gains)),
        falloff_of_(std::move(falloff_of)),
        falloffs_(std::move(falloffs)) {}

  const Light& Gain(uint32_t picture) const { return gains_[picture]; }
  // At a place of the picture, 0 ... 1 from its left and upper side.
  Light FactorAt(uint32_t picture, float x, float y) const;

 private:
  std::vector<Light> gains_;
  std::vector<int> falloff_of_;  // by picture; -1: none
  std::vector<std::array<Light, kNumNodes>> falloffs_;
};

// From what the pictures show of the same blocks: least squares of the logarithms' differences,
// twice, in the second round what differs by more than most counts less. Gains lie between a third
// and three, their mean is one. A camera with fewer than 5 pictures has no falloff, nor has any
// where it cannot be told. Deterministic; a second for some thousand pictures.
Exposure BalanceExposure(const Relief& relief, const std::vector<MapView>& views,
                         const SourceBlocks& sources);

// No change at all.
Exposure EqualExposure(size_t num_pictures);

}  // namespace colmap_seapoint
