#include "colmap_seapoint/tracks/pilot_pictures.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

// `num_strips` strips of `length` pictures; each ties to the next two of its strip and to the one
// beside it.
std::vector<TiedPair> Survey(uint32_t num_strips, uint32_t length) {
  std::vector<TiedPair> pairs;
  for (uint32_t strip = 0; strip < num_strips; ++strip) {
    for (uint32_t i = 0; i < length; ++i) {
      const uint32_t picture = strip * length + i;
      if (i + 1 < length) pairs.push_back({picture, picture + 1, 800});
      if (i + 2 < length) pairs.push_back({picture, picture + 2, 300});
      if (strip + 1 < num_strips) {
        pairs.push_back({picture, picture + length, 150});
        if (i > 0) pairs.push_back({picture, picture + length - 1, 80});
        if (i + 1 < length) pairs.push_back({picture, picture + length + 1, 80});
      }
    }
  }
  return pairs;
}

TEST(PilotPicturesTest, TakesNeighbouringStripsBesideTheFirst) {
  const auto chosen = ChoosePilotPictures(10 * 100, Survey(10, 100), 60);
  ASSERT_EQ(chosen.size(), 60u);
  EXPECT_GE(chosen.back() / 100 - chosen.front() / 100, 4u);  // five strips at least
}

TEST(PilotPicturesTest, OneStripIsTakenAlongItself) {
  const auto chosen = ChoosePilotPictures(100, Survey(1, 100), 20);
  ASSERT_EQ(chosen.size(), 20u);
  EXPECT_EQ(chosen.back() - chosen.front(), 19u);
}

TEST(PilotPicturesTest, WhatDoesNotHangTogetherIsNotTaken) {
  EXPECT_EQ(ChoosePilotPictures(6, {{0, 1, 100}, {2, 3, 50}, {3, 4, 20}}, 6),
            (std::vector<uint32_t>{0, 1}));
  EXPECT_TRUE(ChoosePilotPictures(3, {{0, 1, 29}}, 2).empty());
  EXPECT_TRUE(ChoosePilotPictures(0, {}, 5).empty());
}

}  // namespace
}  // namespace colmap_seapoint
