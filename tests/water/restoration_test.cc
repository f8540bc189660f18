#include "colmap_seapoint/water/restoration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

WaterModel SomeWater() {
  WaterModel water;
  water.state = WaterState::kDetermined;
  water.attenuation = {0.5, 0.2, 0.1};
  water.veil = {0.02, 0.1, 0.2};
  water.veil_rate = {0.6, 0.3, 0.2};
  water.falloff = 3;
  water.white = {1.5, 1.1, 0.9};
  water.max_gain = {4, 8, 8};  // red is as strong as it gets from 2.8 on
  return water;
}

TEST(Restoration, IsRestoreWithinAThousandth) {
  const WaterModel water = SomeWater();
  const Restoration restoration(water, 6);
  for (float range = 0; range < 9; range += 0.137f) {  // the last third beyond the table
    for (const float cosine : {1.0f, 0.93f, 0.71f, 0.05f}) {
      for (const float light : {0.0f, 0.05f, 0.4f, 1.0f}) {
        const auto fast = restoration({light, light, light}, range, cosine);
        const Eigen::Array3f exact = Restore(water, {light, light, light}, range, cosine);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(fast[static_cast<size_t>(c)], exact[c], 1e-3 * (exact[c] + 0.1))
              << range << " " << cosine << " " << light;
        }
      }
    }
  }
}

TEST(Restoration, AnUnknownRangeIsBalancedOnly) {
  const WaterModel water = SomeWater();
  const Restoration restoration(water, 6);
  const auto light = restoration({0.2f, 0.2f, 0.2f}, std::nanf(""), 1);
  const Eigen::Array3f exact = Restore(water, {0.2f, 0.2f, 0.2f}, 0);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(light[static_cast<size_t>(c)], exact[c]);
}

}  // namespace
}  // namespace colmap_seapoint
