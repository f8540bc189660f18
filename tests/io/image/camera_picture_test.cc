// HEIC and RAW, decoded; damaged ones, and files that are none.
#include "colmap_seapoint/io/image/camera_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/image_folder.h"
#include "tests/io/test_files.h"
#include "tests/synthetic/camera_files.h"

namespace colmap_seapoint {
namespace {

using Names = std::vector<std::string>;

// Brighter to the right, a dark square in the upper left corner.
GrayImage Ramp() {
  GrayImage image(128, 96);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.At(x, y) = static_cast<uint8_t>(x < 24 && y < 24 ? 20 : 80 + x);
    }
  }
  return image;
}

// Of the green, away from the edges.
void ExpectLike(const GrayImage& truth, const ColorImage& pixels, double tolerance) {
  ASSERT_EQ(pixels.width, truth.width);
  ASSERT_EQ(pixels.height, truth.height);
  for (const auto& [x, y] :
       {std::pair(10, 10), std::pair(60, 10), std::pair(10, 60), std::pair(100, 80)}) {
    EXPECT_NEAR(pixels.At(x, y, 1), truth.At(x, y), tolerance) << x << " " << y;
  }
}

TEST(CameraPicture, HeicKeepsPixelsAndExif) {
  const TempDir dir;
  if (!WriteHeic(dir / "a.heic", Ramp())) GTEST_SKIP() << "no HEVC encoder";
  const CameraPicture picture = ReadCameraPicture(dir / "a.heic");
  ExpectLike(Ramp(), picture.pixels, 3);
  WriteJpeg(dir / "a.jpg", picture.pixels, picture.exif);
  const ImageInfo info = ReadImageInfo(dir / "a.jpg");
  EXPECT_EQ(info.camera.maker, "TestMaker");
  EXPECT_EQ(info.camera.focal_35mm, 28);
}

TEST(CameraPicture, RawIsDevelopedAsTheSensorHasIt) {
  const TempDir dir;
  WriteDng(dir / "a.dng", Ramp());
  const CameraPicture picture = ReadCameraPicture(dir / "a.dng");
  ExpectLike(Ramp(), picture.pixels, 25);  // libraw's curve is none of 2.2 alone
  WriteJpeg(dir / "a.jpg", picture.pixels, picture.exif);
  const ImageInfo info = ReadImageInfo(dir / "a.jpg");
  EXPECT_EQ(info.camera.maker, "TestMaker");
  EXPECT_EQ(info.camera.model, "TestModel");
  EXPECT_EQ(info.exif_orientation, 6);
}

TEST(CameraPicture, WhatIsNoneIsRefused) {
  const TempDir dir;
  WriteBytes(dir / "empty.heic", "");
  EXPECT_ERROR(ReadCameraPicture(dir / "empty.heic"), "is empty");
  WriteBytes(dir / "text.nef", "this is no picture, whatever it is called");
  EXPECT_ERROR(ReadCameraPicture(dir / "text.nef"), "cannot decode");
  if (WriteHeic(dir / "a.heic", Ramp())) {
    std::filesystem::resize_file(dir / "a.heic", std::filesystem::file_size(dir / "a.heic") / 2);
    EXPECT_ERROR(ReadCameraPicture(dir / "a.heic"), "a.heic");
  }
  WriteDng(dir / "a.dng", Ramp());
  const std::string dng = ReadBytes(dir / "a.dng");
  WriteBytes(dir / "short.dng", dng.substr(0, dng.size() / 2));
  EXPECT_ERROR(ReadCameraPicture(dir / "short.dng"), "short.dng");
}

TEST(CameraPicture, AJpegByAnotherNameIsOne) {
  const TempDir dir;
  WriteImage(dir / "a.jpg", Ramp());
  std::filesystem::rename(dir / "a.jpg", dir / "a.heic");
  ExpectLike(Ramp(), ReadCameraPicture(dir / "a.heic").pixels, 4);
}

TEST(CameraPicture, HeicByAnotherNameIsNamed) {
  const TempDir dir;
  if (!WriteHeic(dir / "a.jpg", Ramp())) GTEST_SKIP() << "no HEVC encoder";
  EXPECT_ERROR(ReadImageInfo(dir / "a.jpg"), "is HEIC by its content");
}

TEST(ListFolder, SortsWhatADiverBrings) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "100GOPRO");
  for (const char* name :
       {"a.JPG", "a.NEF", "b.heic", "b.mov", "c.mov", "dive.MP4", "100GOPRO/GX010001.MP4",
        "100GOPRO/GX010001.LRV", "100GOPRO/GX010001.THM", "Thumbs.db", "notes.txt", ".DS_Store",
        "._a.JPG", "log.csv", "d.heic", "d.dng"}) {
    WriteBytes(dir / name, "x");
  }
  const FolderListing listing = ListFolder(dir.Path());
  EXPECT_EQ(listing.pictures, (Names{"a.JPG"}));
  EXPECT_EQ(listing.camera_pictures, (Names{"b.heic", "d.dng"}));
  EXPECT_EQ(listing.videos, (Names{"100GOPRO/GX010001.MP4", "c.mov", "dive.MP4"}));
  EXPECT_EQ(listing.twins, (Names{"a.NEF", "b.mov", "d.heic"}));
  EXPECT_EQ(listing.others, (Names{"notes.txt"}));
}

TEST(ListFolder, SaysWhatToDoWithWhatItHolds) {
  const TempDir dir;
  WriteBytes(dir / "a.mp4", "x");
  EXPECT_ERROR(ListImages(dir.Path()), "but 1 videos");
  WriteBytes(dir / "a.heic", "x");
  EXPECT_ERROR(ListImages(dir.Path()), "but 1 of HEIC or RAW");
}

}  // namespace
}  // namespace colmap_seapoint
