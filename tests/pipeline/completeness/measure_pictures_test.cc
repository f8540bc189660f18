// Pictures are measured once: what is known of one that has not changed is not asked for again.
#include "colmap_seapoint/pipeline/completeness/measure_pictures.h"

#include <gtest/gtest.h>

#include <random>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/pipeline/completeness/facts_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

bool operator==(const PictureFacts& a, const PictureFacts& b) {
  return a.width == b.width && a.height == b.height && a.texture == b.texture &&
         a.flags == b.flags && a.sharpness == b.sharpness;
}

MeasuredPicture SomePicture(int width, int height) {
  MeasuredPicture picture;
  picture.content = "hash";
  picture.facts.width = width;
  picture.facts.height = height;
  for (int i = 0; i < width * height; ++i) {
    picture.facts.texture.push_back(static_cast<uint8_t>(7 * i));
    picture.facts.flags.push_back(static_cast<uint8_t>(i % 4));
  }
  picture.facts.sharpness = 0.75;
  picture.brightness = 101.5;
  return picture;
}

TEST(FactsFileTest, WhatWasWrittenComesBack) {
  const TempDir dir;
  MeasuredPictures pictures;
  pictures["a.png"] = SomePicture(5, 3);
  pictures["dir/b c.jpg"] = SomePicture(2, 40);
  WriteMeasuredPictures(dir / "facts", pictures);
  const MeasuredPictures read = ReadMeasuredPictures(dir / "facts");
  ASSERT_EQ(read.size(), 2u);
  for (const auto& [name, picture] : pictures) {
    EXPECT_EQ(read.at(name).content, picture.content);
    EXPECT_TRUE(read.at(name).facts == picture.facts) << name;
    EXPECT_EQ(read.at(name).brightness, picture.brightness);
  }
}

TEST(FactsFileTest, NoFileADamagedOneAndAnotherVersionHoldNothing) {
  const TempDir dir;
  EXPECT_TRUE(ReadMeasuredPictures(dir / "none").empty());
  WriteMeasuredPictures(dir / "facts", {{"a.png", SomePicture(5, 3)}});
  const std::string bytes = ReadBytes(dir / "facts");
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    WriteBytes(dir / "damaged", damaged);
    EXPECT_TRUE(ReadMeasuredPictures(dir / "damaged").empty()) << "byte " << i;
    WriteBytes(dir / "damaged", bytes.substr(0, i));
    EXPECT_TRUE(ReadMeasuredPictures(dir / "damaged").empty()) << i << " bytes";
  }
}

class MeasurePicturesTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(dir_ / "images");
    std::filesystem::create_directories(dir_ / "masks");
    for (uint32_t i = 0; i < 4; ++i) {
      PosedImage image;
      image.image_id = i + 1;
      image.name = "p" + std::to_string(i) + ".png";
      WritePicture(image.name, i);
      model_.images.push_back(image);
    }
  }

  void WritePicture(const std::string& name, uint32_t seed) const {
    GrayImage picture(96, 64);
    std::mt19937 random(seed);
    for (uint8_t& value : picture.data) value = static_cast<uint8_t>(64 + random() % 128);
    WriteImage(dir_ / ("images/" + name), picture);
  }

  PictureMeasures Measure(const std::string& facts_file) {
    report_ = {};
    const PictureFolders folders = {dir_ / "images", (dir_ / "masks").string(), facts_file};
    return MeasurePictures(
        model_, folders, 2, [](int64_t) {}, &report_);
  }

  TempDir dir_;
  SparseModel model_;
  RunReport report_;
};

TEST_F(MeasurePicturesTest, AKeptMeasureIsThatOfThePicture) {
  const std::string file = (dir_ / "facts").string();
  const PictureMeasures without = Measure("");
  EXPECT_FALSE(std::filesystem::exists(file));
  for (int run = 0; run < 2; ++run) {
    const PictureMeasures with = Measure(file);
    EXPECT_EQ(with.brightness, without.brightness);
    for (size_t i = 0; i < 4; ++i) EXPECT_TRUE(with.facts[i] == without.facts[i]);
  }
}

TEST_F(MeasurePicturesTest, OnlyWhatHasChangedIsMeasuredAgain) {
  const std::string file = (dir_ / "facts").string();
  const PictureMeasures first = Measure(file);
  MeasuredPictures kept = ReadMeasuredPictures(file);
  ASSERT_EQ(kept.size(), 4u);
  for (auto& [name, picture] : kept) picture.brightness = -7;  // no picture's
  WriteMeasuredPictures(file, kept);
  WritePicture("p1.png", 99);
  GrayImage mask(96, 64);
  WriteImage(dir_ / "masks/p2.png.png", mask);
  const PictureMeasures second = Measure(file);
  EXPECT_EQ(second.brightness[0], -7);
  EXPECT_GT(second.brightness[1], 0);
  EXPECT_NE(second.brightness[1], first.brightness[1]);
  EXPECT_EQ(second.brightness[2], first.brightness[2]);
  EXPECT_EQ(second.facts[2].flags[0] & kMaskedCell, kMaskedCell);
  EXPECT_EQ(second.brightness[3], -7);
}

TEST_F(MeasurePicturesTest, APictureThatCannotBeReadIsNamedEachTime) {
  const std::string file = (dir_ / "facts").string();
  WriteBytes(dir_ / "images/p3.png", "no picture");
  for (int run = 0; run < 2; ++run) {
    const PictureMeasures measures = Measure(file);
    ASSERT_EQ(report_.left_out.size(), 1u);
    EXPECT_EQ(report_.left_out[0].name, "p3.png");
    EXPECT_TRUE(measures.facts[3].is_bad);
    EXPECT_EQ(ReadMeasuredPictures(file).size(), 3u);
  }
}

TEST_F(MeasurePicturesTest, NoneThatCanBeReadIsAnError) {
  for (const PosedImage& image : model_.images) WriteBytes(dir_ / ("images/" + image.name), "no");
  EXPECT_THROW(Measure(""), Error);
}

}  // namespace
}  // namespace colmap_seapoint
