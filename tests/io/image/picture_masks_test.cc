#include "colmap_seapoint/io/image/picture_masks.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/expect_error.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

class PictureMasksTest : public testing::Test {
 protected:
  // The left half of a mask of that size is hidden.
  static GrayImage LeftHalf(int width, int height) {
    GrayImage mask(width, height, 1, 255);
    for (int y = 0; y < height; ++y) std::fill(mask.Row(y), mask.Row(y) + width / 2, uint8_t{0});
    return mask;
  }

  GrayImage Decode(int width = 40, int height = 30) const {
    return masks_.Decode("a.jpg", masks_.Open("a.jpg"), width, height);
  }

  TempDir dir_;
  PictureMasks masks_{dir_.Path().string()};
};

TEST_F(PictureMasksTest, OfThePicturesSize) {
  WriteImage(dir_ / "a.jpg.png", LeftHalf(40, 30));
  EXPECT_EQ(Decode().data, LeftHalf(40, 30).data);
  EXPECT_TRUE(masks_.Decode("b.jpg", masks_.Open("b.jpg"), 40, 30).Empty());
  EXPECT_FALSE(PictureMasks("").Open("a.jpg"));
}

TEST_F(PictureMasksTest, ScaledInTheSameProportionsOnly) {
  WriteImage(dir_ / "a.jpg.png", LeftHalf(20, 15));
  EXPECT_EQ(Decode().data, LeftHalf(40, 30).data);
  WriteImage(dir_ / "a.jpg.png", LeftHalf(80, 60));
  EXPECT_EQ(Decode().data, LeftHalf(40, 30).data);
  WriteImage(dir_ / "a.jpg.png", LeftHalf(30, 40));
  EXPECT_ERROR(Decode(), "a.jpg.png: its mask is of another size than the picture: 30x40");
}

TEST_F(PictureMasksTest, ColourAndSixteenBits) {
  const std::string path = (dir_ / "a.jpg.png").string();
  cv::Mat colour(30, 40, CV_8UC3, cv::Scalar(255, 255, 255)), deep(30, 40, CV_16UC1, cv::Scalar(1));
  colour.colRange(0, 20).setTo(cv::Scalar(0, 0, 0));
  deep.colRange(0, 20).setTo(cv::Scalar(0));
  cv::imwrite(path, colour);
  EXPECT_EQ(Decode().data, LeftHalf(40, 30).data);
  cv::imwrite(path, deep);
  EXPECT_EQ(Decode().data, LeftHalf(40, 30).data);
}

TEST_F(PictureMasksTest, APixelMoreForResampling) {
  GrayImage mask(40, 30, 1, 255);
  mask.At(10, 20) = 0;
  mask.At(0, 0) = 0;
  WriteImage(dir_ / "a.jpg.png", mask);
  const GrayImage grown = masks_.ReadForResampling("a.jpg", 40, 30);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const bool is_near = (std::abs(x - 10) <= 1 && std::abs(y - 20) <= 1) || (x <= 1 && y <= 1);
      EXPECT_EQ(grown.At(x, y) == 0, is_near) << x << " " << y;
    }
  }
  EXPECT_TRUE(masks_.ReadForResampling("b.jpg", 40, 30).Empty());
}

TEST_F(PictureMasksTest, ProblemsSeenInTheHeader) {
  WriteImage(dir_ / "a.jpg.png", LeftHalf(20, 15));
  EXPECT_EQ(masks_.Problem("a.jpg", 40, 30), "");
  EXPECT_NE(masks_.Problem("a.jpg", 30, 40).find("another size"), std::string::npos);
  EXPECT_EQ(masks_.Problem("b.jpg", 30, 40), "");
  WriteBytes(dir_ / "b.jpg.png", "no picture");
  EXPECT_NE(masks_.Problem("b.jpg", 40, 30), "");
}

TEST_F(PictureMasksTest, Damaged) {
  WriteBytes(dir_ / "a.jpg.png", "no picture");
  EXPECT_ERROR(masks_.Open("a.jpg"), "a.jpg.png: its mask");
  EXPECT_NE(masks_.Fingerprint({"a.jpg"}), "");
}

TEST_F(PictureMasksTest, AFolderOfOtherMasksIsAnError) {
  WriteImage(dir_ / "a.png", LeftHalf(40, 30));
  EXPECT_ERROR(masks_.Check({"a.jpg", "b.jpg"}, "--mask_path"), "e.g. a.jpg.png");
  EXPECT_ERROR(PictureMasks((dir_ / "none").string()).Check({"a.jpg"}, "--mask_path"),
               "check --mask_path");
  PictureMasks("").Check({"a.jpg"}, "--mask_path");
  WriteImage(dir_ / "a.jpg.png", LeftHalf(40, 30));
  masks_.Check({"a.jpg", "b.jpg"}, "--mask_path");
}

TEST_F(PictureMasksTest, FingerprintFollowsTheMasks) {
  const std::string without = masks_.Fingerprint({"a.jpg"});
  WriteImage(dir_ / "a.jpg.png", LeftHalf(40, 30));
  const std::string with = masks_.Fingerprint({"a.jpg"});
  EXPECT_NE(with, without);
  EXPECT_EQ(masks_.Fingerprint({"a.jpg", "b.jpg"}), with);
  WriteImage(dir_ / "a.jpg.png", GrayImage(40, 30, 1, 255));
  EXPECT_NE(masks_.Fingerprint({"a.jpg"}), with);
}

}  // namespace
}  // namespace colmap_seapoint
