#include "colmap_seapoint/orthomosaic/sources/exposure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/orthomosaic/sources/source_world.h"

namespace colmap_seapoint {
namespace {

TEST(Exposure, FindsTheGainsOfAllPictures) {
  const SourceWorld world(12, 40, 40);
  const auto gain = [](uint32_t picture, size_t c) {
    return std::exp(0.25 * std::sin(1.0 + picture) * (1 + 0.3 * static_cast<double>(c)));
  };
  SourceBlocks sources = world.Sources(
      [&](uint32_t picture, const Eigen::Vector2d&, size_t c) { return gain(picture, c); });
  const Exposure exposure = BalanceExposure(world.GetRelief(), world.Views(), sources);
  for (uint32_t i = 1; i < 12; ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const double found = double{exposure.Gain(i)[c] / exposure.Gain(0)[c]};
      EXPECT_NEAR(found * gain(i, c) / gain(0, c), 1, 0.02) << i << " " << c;
    }
  }
  double sum = 0;
  for (uint32_t i = 0; i < 12; ++i) sum += std::log(double{exposure.Gain(i)[0]});
  EXPECT_NEAR(sum, 0, 0.05);
}

TEST(Exposure, FindsWhatTheLampTakesAwayAtTheBorders) {
  const SourceWorld world(12, 40, 40);
  const auto falloff = [](const Eigen::Vector2d& place) {
    return 1 - 0.9 * (place - Eigen::Vector2d(0.5, 0.5)).squaredNorm();
  };
  SourceBlocks sources =
      world.Sources([&](uint32_t, const Eigen::Vector2d& place, size_t) { return falloff(place); });
  const Exposure exposure = BalanceExposure(world.GetRelief(), world.Views(), sources);
  const auto balanced = [&](float x, float y) {
    return double{exposure.FactorAt(3, x, y)[1]} * falloff({double{x}, double{y}});
  };
  for (const float x : {0.15f, 0.5f, 0.85f}) {
    for (const float y : {0.15f, 0.5f, 0.85f}) {
      EXPECT_NEAR(balanced(x, y) / balanced(0.5f, 0.5f), 1, 0.06) << x << " " << y;
    }
  }
}

TEST(Exposure, GrossErrorsCountLittle) {
  const SourceWorld world(12, 40, 40);
  int count = 0;
  SourceBlocks sources = world.Sources([&](uint32_t picture, const Eigen::Vector2d&, size_t c) {
    if (c == 0) ++count;
    return picture == 4 && count % 5 == 0 ? 2.0 : 1.0;  // a diver
  });
  const Exposure exposure = BalanceExposure(world.GetRelief(), world.Views(), sources);
  for (uint32_t i = 0; i < 12; ++i) EXPECT_NEAR(exposure.Gain(i)[1], 1, 0.06) << i;
}

TEST(Exposure, NothingInCommonChangesNothing) {
  const SourceWorld world(12, 40, 40);
  SourceBlocks sources =
      world.Sources([](uint32_t, const Eigen::Vector2d&, size_t) { return 1.0; });
  for (Source& source : sources.sources) source.rgb = {0, 0, 0};
  const Exposure exposure = BalanceExposure(world.GetRelief(), world.Views(), sources);
  for (uint32_t i = 0; i < 12; ++i) {
    EXPECT_EQ(exposure.FactorAt(i, 0.1f, 0.8f), (Light{1, 1, 1}));
  }
}

// Pictures that grow darker all along the survey may be so because the ground does.
TEST(Exposure, ChangesNoColourAllOverTheMap) {
  const SourceWorld world(12, 40, 40);
  SourceBlocks sources = world.Sources([](uint32_t picture, const Eigen::Vector2d&, size_t) {
    return std::exp(-0.1 * (picture % 6));
  });
  const Exposure exposure = BalanceExposure(world.GetRelief(), world.Views(), sources);
  double with[2] = {0, 0}, without[2] = {0, 0};  // mean logarithms in the left and right third
  int count[2] = {0, 0};
  const BlockRelief& blocks = world.GetRelief().Blocks();
  for (int y = 0; y < blocks.height; ++y) {
    for (int x = 0; x < blocks.width; ++x) {
      const int32_t at = sources.slot[blocks.At(x, y)];
      const int side = x < 13 ? 0 : 1;
      if (at < 0 || sources.Of(at)[0].picture == kNoPicture || (x >= 13 && x < 27)) continue;
      const Eigen::Vector3d place = PlaceInBlock(world.GetRelief(), x, y);
      const uint32_t picture = sources.Of(at)[0].picture;
      const auto pixel = world.Views()[picture].PixelOf(place);
      const Light factor = exposure.FactorAt(picture, static_cast<float>(pixel->x() / 480),
                                             static_cast<float>(pixel->y() / 500));
      without[side] += std::log(double{factor[1]});
      with[side] += std::log(double{factor[1] * exposure.FactorOnMap(place.head<2>())[1]});
      ++count[side];
    }
  }
  ASSERT_GT(std::min(count[0], count[1]), 300);
  EXPECT_GT(without[1] / count[1] - without[0] / count[0], 0.25);
  EXPECT_NEAR(with[1] / count[1], with[0] / count[0], 0.05);
  EXPECT_NEAR(with[0] / count[0], 0, 0.05);
}

}  // namespace
}  // namespace colmap_seapoint
