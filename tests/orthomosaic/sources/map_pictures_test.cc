#include "colmap_seapoint/orthomosaic/sources/map_pictures.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"

namespace colmap_seapoint {
namespace {

Picture Plain(int size, uint8_t value) {
  Picture picture;
  picture.luma = GrayImage(size, size, 1, value);
  return picture;
}

TEST(MapPictures, AreReadOnceWhileTheyFit) {
  std::atomic<int> num_reads{0};
  const MapPictureReader read = [&](size_t i) {
    ++num_reads;
    return Plain(10, static_cast<uint8_t>(i));
  };
  MapPictures pictures(read, std::vector<int>(8, 0), 8 * 100);
  ParallelFor(4, 64, [&](int64_t i) {
    EXPECT_EQ(pictures.Get(static_cast<uint32_t>(i % 8))->luma.At(3, 3), i % 8);
  });
  EXPECT_EQ(num_reads, 8);
  EXPECT_EQ(pictures.NumReads(), 8u);
}

TEST(MapPictures, TheOneUnusedForLongestGoes) {
  std::vector<size_t> reads;
  const MapPictureReader read = [&](size_t i) {
    reads.push_back(i);
    return Plain(10, static_cast<uint8_t>(i));
  };
  MapPictures pictures(read, {0, 0, 0}, 200);
  for (const uint32_t i : {0, 1, 0, 2, 0, 1}) pictures.Get(i);
  EXPECT_EQ(reads, (std::vector<size_t>{0, 1, 2, 1}));
}

TEST(MapPictures, AReaderThatThrowsLeavesNothingBehind) {
  bool fails = true;
  const MapPictureReader read = [&](size_t) -> Picture {
    if (fails) throw std::runtime_error("gone");
    return Plain(4, 7);
  };
  MapPictures pictures(read, {0}, 100);
  EXPECT_THROW(pictures.Get(0), std::runtime_error);
  fails = false;
  EXPECT_EQ(pictures.Get(0)->luma.At(0, 0), 7);
}

TEST(MapPictures, AreHalvedWithTheirMasks) {
  Picture picture = Plain(5, 0);
  picture.luma.At(0, 0) = 100;
  picture.luma.At(1, 1) = 60;
  picture.mask = GrayImage(5, 5, 1, 255);
  picture.mask.At(3, 2) = 0;
  const Picture half = HalvedPicture(picture);
  EXPECT_EQ(half.luma.width, 2);
  EXPECT_EQ(half.luma.At(0, 0), 40);
  EXPECT_EQ(half.mask.At(1, 1), 0);
  EXPECT_EQ(half.mask.At(0, 1), 255);
  EXPECT_EQ(HalvedPicture(Plain(1, 9)).luma.At(0, 0), 9);
  EXPECT_TRUE(HalvedPicture(Picture()).Empty());
}

TEST(PictureSample, ScreenAndLightAreInverse) {
  for (int value = 0; value < 256; ++value) {
    EXPECT_EQ(ScreenOf(LightOf(static_cast<float>(value))), value);
  }
  EXPECT_EQ(ScreenOf(2), 255);
  EXPECT_EQ(ScreenOf(-1), 0);
}

TEST(PictureSample, IsLinearBetweenPixelCentres) {
  Picture picture = Plain(4, 0);
  for (int i = 0; i < 16; ++i) {
    picture.luma.At(i % 4, i / 4) = static_cast<uint8_t>(20 * (i % 4) + 50 * (i / 4));
  }
  EXPECT_FLOAT_EQ(ScreenColorAt(picture, 1.5f, 2.5f)[0], 120);
  EXPECT_FLOAT_EQ(ScreenColorAt(picture, 1.75f, 2.25f)[1], 20 * 1.25f + 50 * 1.75f);
  EXPECT_FLOAT_EQ(ScreenColorAt(picture, 4, 4)[2], 210);
}

}  // namespace
}  // namespace colmap_seapoint
