#include "densify/overlap/packed_footprint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace colmap_seapoint {
namespace {

// What a picture of 200 x 150 cells leaves of a wavy ground 2 units below, where `holds` says so:
// patches 0.012 to 0.02 large, far from the world's origin.
template <typename Holds>
CloudFootprint WavyFootprint(const Holds& holds) {
  constexpr double kCell = 0.008;  // of the focal length
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.0003);
  CloudFootprint footprint;
  for (int b = 0; b < 150; ++b) {
    for (int a = 0; a < 200; ++a) {
      if (!holds(a, b)) continue;
      const double depth = 2 + 0.3 * std::sin(0.1 * a) * std::cos(0.07 * b) + noise(random);
      const Eigen::Vector3d place(depth * kCell * (a - 100), depth * kCell * (b - 75), depth);
      footprint.patches.push_back({(place + Eigen::Vector3d(900, -700, 30)).cast<float>(),
                                   static_cast<float>(kCell * place.norm())});
    }
  }
  footprint.UpdateSphere();
  return footprint;
}

// Largest distance between patches that went in and came out, in sides of the smallest patch.
double WorstRounding(const CloudFootprint& footprint, const PackedFootprint& packed) {
  double smallest = 1e30, worst = 0;
  for (const SurfacePatch& patch : footprint.patches) {
    smallest = std::min<double>(smallest, patch.size);
  }
  size_t i = 0;
  packed.ForEach([&](const SurfacePatch& patch) {
    const SurfacePatch& before = footprint.patches.at(i++);
    worst = std::max<double>(worst, (patch.center - before.center).cwiseAbs().maxCoeff());
    worst = std::max<double>(worst, std::abs(patch.size - before.size));
  });
  EXPECT_EQ(i, footprint.patches.size());
  return worst / smallest;
}

TEST(PackedFootprintTest, ComesBackRoundedInASixthOfTheMemory) {
  const CloudFootprint footprint = WavyFootprint([](int, int) { return true; });
  const PackedFootprint packed = footprint;
  EXPECT_EQ(packed.NumPatches(), footprint.patches.size());
  EXPECT_EQ(packed.Center(), footprint.center);
  EXPECT_EQ(packed.Radius(), footprint.radius);
  // Half a unit, and the float's own 6e-5 at this distance from the origin.
  EXPECT_LT(WorstRounding(footprint, packed), 0.5 / 32 + 0.006);
  EXPECT_LT(6 * packed.NumBytes(), footprint.patches.size() * sizeof(SurfacePatch));
}

TEST(PackedFootprintTest, HolesAndStripesComeBackToo) {
  const CloudFootprint footprint =
      WavyFootprint([](int a, int b) { return (a * b) % 7 < 3 && (a < 20 || a > 150); });
  EXPECT_LT(WorstRounding(footprint, footprint), 0.5 / 32 + 0.006);
}

TEST(PackedFootprintTest, OddOnes) {
  const PackedFootprint empty = CloudFootprint();
  EXPECT_EQ(empty.NumPatches(), 0u);
  EXPECT_EQ(empty.NumBytes(), 0u);
  CloudFootprint one;
  one.patches = {{{1, 2, 3}, 0.5f}};
  one.UpdateSphere();
  EXPECT_LT(WorstRounding(one, one), 1e-6);
  // A million times as far apart as they are large: no finer than their floats.
  CloudFootprint apart;
  apart.patches = {{{-4e5f, 0, 0}, 0.4f}, {{4e5f, 1e5f, -3e5f}, 3e4f}, {{0, 0, 7}, 0.4f}};
  apart.UpdateSphere();
  EXPECT_LT(WorstRounding(apart, apart), 1);
}

}  // namespace
}  // namespace colmap_seapoint
