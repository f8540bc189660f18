// What the limits of image_limits.h must let pass: pictures of one colour, packed as tightly as
// each format's library can.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 6000, kHeight = 4000;  // as a camera has them

struct Encoding {
  const char* name;
  std::vector<int> options;
};

TEST(ImageLimits, PicturesOfOneColour) {
  const TempDir dir;
  const Encoding encodings[] = {
      {"baseline.jpg", {cv::IMWRITE_JPEG_QUALITY, 1, cv::IMWRITE_JPEG_OPTIMIZE, 1}},
      {"progressive.jpg",
       {cv::IMWRITE_JPEG_QUALITY, 1, cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_OPTIMIZE,
        1}},
      {"a.png", {cv::IMWRITE_PNG_COMPRESSION, 9}},
      {"mask.png", {cv::IMWRITE_PNG_COMPRESSION, 9, cv::IMWRITE_PNG_BILEVEL, 1}},
      {"none.tif", {cv::IMWRITE_TIFF_COMPRESSION, 1}},
      {"lzw.tif", {cv::IMWRITE_TIFF_COMPRESSION, 5}},
      {"deflate.tif", {cv::IMWRITE_TIFF_COMPRESSION, 8}},
      {"packbits.tif", {cv::IMWRITE_TIFF_COMPRESSION, 32773}},
      {"a.webp", {cv::IMWRITE_WEBP_QUALITY, 80}},
  };
  for (const Encoding& encoding : encodings) {
    for (const int level : {0, 255}) {
      const cv::Mat picture(kHeight, kWidth, CV_8UC1, cv::Scalar(level));
      ASSERT_TRUE(cv::imwrite((dir / encoding.name).string(), picture, encoding.options));
      EXPECT_EQ(ReadImageInfo(dir / encoding.name).width, kWidth) << encoding.name;
      const GrayImage gray = ReadGrayImage(dir / encoding.name);
      EXPECT_EQ(gray.height, kHeight) << encoding.name;
      EXPECT_NEAR(gray.At(kWidth / 2, kHeight / 2), level, 2) << encoding.name;
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
