// Pictures of one place brought to one brightness and colour (ours).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"
#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"

namespace colmap_seapoint {

// What balancing changes all over the map, and must not: logarithms, linear about a place of it. In
// neighbours a slanted falloff looks like gains that rise along the survey.
struct ExposureTrend {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // in the map's frame
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();   // by channel
  Eigen::Vector3d along_x = Eigen::Vector3d::Zero(), along_y = Eigen::Vector3d::Zero();
};

// What the light of a picture is multiplied with: a gain a picture and channel, and what lamp and
// lens take away towards the borders, the same in all pictures of one camera.
class Exposure {
 public:
  static constexpr int kNodesX = 7, kNodesY = 5;  // of the falloff, over the picture
  static constexpr int kNumNodes = kNodesX * kNodesY;

  Exposure(std::vector<Light> gains, std::vector<int> falloff_of,
           std::vector<std::array<Light, kNumNodes>> falloffs, const ExposureTrend& trend = {})
      : gains_(std::move(gains)),
        falloff_of_(std::move(falloff_of)),
        falloffs_(std::move(falloffs)),
        trend_(trend) {}

  const std::vector<Light>& Gains() const { return gains_; }
  const std::vector<int>& FalloffOf() const { return falloff_of_; }
  const std::vector<std::array<Light, kNumNodes>>& Falloffs() const { return falloffs_; }
  const ExposureTrend& Trend() const { return trend_; }
  const Light& Gain(uint32_t picture) const { return gains_[picture]; }
  // At a place of the picture, 0 ... 1 from its left and upper side.
  Light FactorAt(uint32_t picture, float x, float y) const;
  // Of all pictures, at a place of the map: takes the trend back.
  Light FactorOnMap(const Eigen::Vector2d& place) const;

 private:
  std::vector<Light> gains_;
  std::vector<int> falloff_of_;  // by picture; -1: none
  std::vector<std::array<Light, kNumNodes>> falloffs_;
  ExposureTrend trend_;
};

// From what the pictures show of the same blocks: least squares of the logarithms' differences,
// twice, in the second round what differs by more than most counts less. Gains lie between a third
// and three, their mean is one. A camera with fewer than 5 pictures has no falloff, nor has any
// where it cannot be told. Deterministic; a second for some thousand pictures.
Exposure BalanceExposure(const Relief& relief, const std::vector<MapView>& views,
                         const SourceBlocks& sources);

// Of a map that is continued: what it had stays; pictures that came in since get their gains from
// what they show of the blocks that are not kept, and the falloff of their camera.
Exposure ContinueExposure(const Exposure& before, const Relief& relief,
                          const std::vector<MapView>& views, const SourceBlocks& sources);

// No change at all.
Exposure EqualExposure(size_t num_pictures);

}  // namespace colmap_seapoint
