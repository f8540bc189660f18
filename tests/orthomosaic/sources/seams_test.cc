#include "colmap_seapoint/orthomosaic/sources/seams.h"

#include <gtest/gtest.h>

#include "tests/orthomosaic/sources/source_world.h"

namespace colmap_seapoint {
namespace {

constexpr auto kAlike = [](uint32_t, const Eigen::Vector2d&, size_t) { return 1.0; };

// From column `first` on.
int NumSeams(const BlockRelief& blocks, const SourceBlocks& sources, int first = 0) {
  int count = 0;
  for (int y = 0; y < blocks.height; ++y) {
    for (int x = first + 1; x < blocks.width; ++x) {
      count += sources.PictureOf(blocks.At(x, y)) != sources.PictureOf(blocks.At(x - 1, y));
    }
  }
  return count;
}

// Where costs are noisy, as if there were no seams to care for.
SourceBlocks NoisySources(const SourceWorld& world) {
  SourceBlocks sources = world.Sources(kAlike);
  uint32_t state = 1;
  for (Source& source : sources.sources) {
    state = state * 1664525 + 1013904223;
    source.cost += 0.15f * static_cast<float>(state >> 16) / 65536;
  }
  for (size_t i = 0; i < sources.NumSlots(); ++i) {
    const Source* list = sources.Of(static_cast<int32_t>(i));
    for (uint8_t k = 1; k < kMaxSources && list[k].picture != kNoPicture; ++k) {
      if (list[k].cost < list[sources.choice[i]].cost) sources.choice[i] = k;
    }
  }
  return sources;
}

TEST(SourceBlocks, TheNearestPictureIsTheCheapestOnFlatGround) {
  const SourceWorld world(8, 40, 40);
  const SourceBlocks sources = world.Sources(kAlike);
  const BlockRelief& blocks = world.GetRelief().Blocks();
  for (int y = 0; y < blocks.height; ++y) {
    for (int x = 0; x < blocks.width; ++x) {
      const Eigen::Vector3d place = PlaceInBlock(world.GetRelief(), x, y);
      const Source* list = sources.Of(sources.slot[blocks.At(x, y)]);
      double nearest = 1e9;
      for (const MapView& view : world.Views()) {
        nearest = std::min(nearest, (view.Center() - place).norm());
      }
      EXPECT_NEAR((world.Views()[list[0].picture].Center() - place).norm(), nearest, 8);
      for (int k = 1; k < kMaxSources; ++k) {
        if (list[k].picture != kNoPicture) {
          EXPECT_LE(list[k - 1].cost, list[k].cost);
        }
      }
    }
  }
}

TEST(SourceBlocks, AreTheSameForAnyNumberOfThreads) {
  const SourceWorld world(8, 40, 40);
  const SourceBlocks one = FindSources(world.GetRelief(), world.Views(), 1);
  const SourceBlocks four = FindSources(world.GetRelief(), world.Views(), 4);
  ASSERT_EQ(one.sources.size(), four.sources.size());
  for (size_t i = 0; i < one.sources.size(); ++i) {
    EXPECT_EQ(one.sources[i].picture, four.sources[i].picture);
  }
}

TEST(Seams, NoiseInTheCostsMakesNoIslands) {
  const SourceWorld world(8, 40, 40);
  SourceBlocks sources = NoisySources(world);
  const BlockRelief& blocks = world.GetRelief().Blocks();
  const int before = NumSeams(blocks, sources);
  const Exposure exposure = EqualExposure(8);
  ChooseSources(blocks, exposure, 1, &sources);
  const int after = NumSeams(blocks, sources);
  EXPECT_LT(after, before);
  EXPECT_LT(after, 3 * 40 + 40);  // three seams across the rows, and what is between the strips
  const std::vector<uint8_t> choice = sources.choice;
  ChooseSources(blocks, exposure, 4, &sources);
  EXPECT_EQ(sources.choice, choice);
}

// A cross of them lies in the map, three blocks broad, so that every line meets them.
TEST(Seams, GoOnBehindBlocksThatNoPictureColours) {
  const SourceWorld world(8, 40, 40);
  const BlockRelief& blocks = world.GetRelief().Blocks();
  SourceBlocks whole = NoisySources(world);
  for (size_t i = 0; i < whole.NumSlots(); ++i) {
    Source* list = whole.Of(static_cast<int32_t>(i));
    std::stable_sort(list, list + kMaxSources, [](const Source& a, const Source& b) {
      return a.picture != kNoPicture && (b.picture == kNoPicture || a.cost < b.cost);
    });
    whole.choice[i] = 0;
  }
  SourceBlocks broken = whole;
  const auto is_cross = [](int x, int y) { return std::abs(x - 11) <= 1 || std::abs(y - 11) <= 1; };
  for (int y = 0; y < blocks.height; ++y) {
    for (int x = 0; x < blocks.width; ++x) {
      const int32_t at = broken.slot[blocks.At(x, y)];
      if (is_cross(x, y)) std::fill_n(broken.Of(at), kMaxSources, Source());
    }
  }
  const int before = NumSeams(blocks, whole, 13);
  for (SourceBlocks* sources : {&whole, &broken}) {
    ChooseSources(blocks, EqualExposure(8), 1, sources);
  }
  const int after = NumSeams(blocks, whole, 13);
  ASSERT_LT(after, before);
  EXPECT_LE(NumSeams(blocks, broken, 13), after + 10);
}

// Something stands in column 20 of the map, and looks different in every picture.
TEST(Seams, LieWherePicturesAgree) {
  const SourceWorld world(8, 40, 40);
  const BlockRelief& blocks = world.GetRelief().Blocks();
  SourceBlocks sources = world.Sources(kAlike);
  const auto num_at = [&](int column) {
    int count = 0;
    for (int y = 0; y < blocks.height; ++y) {
      count +=
          sources.PictureOf(blocks.At(column, y)) != sources.PictureOf(blocks.At(column + 1, y));
    }
    return count;
  };
  ChooseSources(blocks, EqualExposure(8), 1, &sources);
  ASSERT_GT(num_at(19), 20);  // midway between two cameras
  for (int y = 0; y < blocks.height; ++y) {
    for (const int x : {19, 20}) {
      Source* list = sources.Of(sources.slot[blocks.At(x, y)]);
      for (int k = 0; k < kMaxSources; ++k) {
        if (list[k].picture != kNoPicture && list[k].picture % 2 == 0) list[k].rgb = {20, 20, 20};
      }
    }
  }
  ChooseSources(blocks, EqualExposure(8), 1, &sources);
  EXPECT_LT(num_at(19), 5);
}

}  // namespace
}  // namespace colmap_seapoint
