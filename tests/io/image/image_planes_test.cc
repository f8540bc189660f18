// JPEG files of every kind decoded into planes, against OpenCV's decoder and our own in grey.
#include <cstdio>
// jpeglib.h needs <cstdio> before it.
#include <gtest/gtest.h>
#include <jpeglib.h>

#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <vector>

#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

struct JpegKind {
  const char* name;
  int luma_x, luma_y;  // sampling factors of luma; those of the chroma are 1
  bool progressive = false;
  int restart_interval = 0;  // blocks (MCU)
  J_COLOR_SPACE stored = JCS_YCbCr;
};

// Red, green and blue that change slowly, with some noise.
std::vector<uint8_t> SmoothPixels(int width, int height, int channels) {
  std::vector<uint8_t> pixels;
  std::mt19937 random(3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const double wave = std::sin(0.13 * x + 0.9 * c) + std::cos(0.09 * y - 0.7 * c);
        pixels.push_back(static_cast<uint8_t>(128 + 50 * wave + static_cast<int>(random() % 9)));
      }
    }
  }
  return pixels;
}

void WriteJpeg(const std::filesystem::path& path, const JpegKind& kind, int width, int height) {
  const int channels = kind.stored == JCS_GRAYSCALE ? 1 : kind.stored == JCS_YCCK ? 4 : 3;
  std::vector<uint8_t> pixels = SmoothPixels(width, height, channels);
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  jpeg_stdio_dest(&info, file);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = channels;
  info.in_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 4 ? JCS_CMYK : JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_colorspace(&info, kind.stored);
  jpeg_set_quality(&info, 90, TRUE);
  info.comp_info[0].h_samp_factor = kind.luma_x;
  info.comp_info[0].v_samp_factor = kind.luma_y;
  for (int c = 1; c < channels; ++c) {
    info.comp_info[c].h_samp_factor = info.comp_info[c].v_samp_factor = 1;
  }
  info.restart_interval = static_cast<unsigned>(kind.restart_interval);
  if (kind.progressive) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row = pixels.data() + info.next_scanline * static_cast<size_t>(width * channels);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::fclose(file);
}

const JpegKind kKinds[] = {
    {"444", 1, 1},
    {"422", 2, 1},
    {"440", 1, 2},
    {"420", 2, 2},
    {"411", 4, 1},
    {"410", 4, 2},
    {"420 progressive", 2, 2, true},
    {"422 progressive", 2, 1, true},
    {"420 restarts", 2, 2, false, 3},
    {"thirds", 3, 1},  // a grid that Picture does not know
    {"grey", 1, 1, false, 0, JCS_GRAYSCALE},
    {"rgb", 1, 1, false, 0, JCS_RGB},
    {"ycck", 1, 1, false, 0, JCS_YCCK},
};

class ImagePlanes : public testing::TestWithParam<JpegKind> {
 protected:
  TempDir dir_;
};

// Largest and mean difference over all values.
void ExpectClose(const Image<uint8_t>& one, const Image<uint8_t>& other, int largest, double mean) {
  ASSERT_EQ(one.data.size(), other.data.size());
  double sum = 0;
  for (size_t i = 0; i < one.data.size(); ++i) {
    const int difference = std::abs(one.data[i] - other.data[i]);
    ASSERT_LE(difference, largest) << i;
    sum += difference;
  }
  EXPECT_LE(sum / static_cast<double>(one.data.size()), mean);
}

Picture WithRepeatedChroma(const Picture& picture) {
  Picture repeated;
  repeated.luma = repeated.cb = repeated.cr = picture.luma;
  for (int y = 0; y < picture.luma.height; ++y) {
    for (int x = 0; x < picture.luma.width; ++x) {
      const int at_x = x >> picture.chroma_shift_x, at_y = y >> picture.chroma_shift_y;
      repeated.cb.At(x, y) = picture.cb.At(at_x, at_y);
      repeated.cr.At(x, y) = picture.cr.At(at_x, at_y);
    }
  }
  return repeated;
}

TEST_P(ImagePlanes, SameLumaWithAndWithoutColorAndTheSameColors) {
  const JpegKind& kind = GetParam();
  const auto path = dir_ / "a.jpg";
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{
           {64, 48}, {97, 65}, {95, 63}, {33, 31}, {17, 1}, {1, 17}, {1, 1}, {3, 5}}) {
    SCOPED_TRACE(std::string(kind.name) + " " + std::to_string(width) + "x" +
                 std::to_string(height));
    WriteJpeg(path, kind, width, height);
    const Picture picture = ReadPicture(path);
    ASSERT_EQ(picture.luma.width, width);
    ASSERT_EQ(picture.luma.height, height);
    EXPECT_EQ(picture.luma.data, ReadGrayImage(path).data);
    EXPECT_EQ(picture.HasColor(), kind.stored != JCS_GRAYSCALE);
    // libjpeg repeats chroma that it does not interpolate: of four pixels a sample, or two samples.
    const bool repeats =
        picture.chroma_shift_x == 2 || (picture.chroma_shift_x == 1 && picture.cb.width <= 2);
    const Picture oracle = repeats ? WithRepeatedChroma(picture) : picture;
    ExpectClose(ColorOf(oracle), ReadColorImage(path), repeats ? 0 : 2, 0.6);
  }
}

TEST_P(ImagePlanes, TruncatedIsAnError) {
  WriteJpeg(dir_ / "whole.jpg", GetParam(), 97, 65);
  const std::string whole = ReadBytes(dir_ / "whole.jpg");
  EXPECT_NO_THROW(ReadPicture(dir_ / "whole.jpg"));
  for (size_t size = 4; size < whole.size(); size += 1 + whole.size() / 50) {
    WriteBytes(dir_ / "cut.jpg", whole.substr(0, size));
    EXPECT_ERROR(ReadPicture(dir_ / "cut.jpg"), "copy the picture again");
  }
}

TEST_P(ImagePlanes, DamagedInColorIsDamagedInGrey) {
  WriteJpeg(dir_ / "whole.jpg", GetParam(), 97, 65);
  const std::string whole = ReadBytes(dir_ / "whole.jpg");
  std::mt19937 random(4);
  int num_read = 0;
  for (int i = 0; i < 100; ++i) {
    std::string damaged = whole;
    damaged[4 + random() % (whole.size() - 4)] = static_cast<char>(random());
    WriteBytes(dir_ / "damaged.jpg", damaged);
    std::string in_color, in_gray;
    Picture picture;
    GrayImage gray;
    try {
      picture = ReadPicture(dir_ / "damaged.jpg");
    } catch (const Error& error) {
      in_color = error.what();
    }
    try {
      gray = ReadGrayImage(dir_ / "damaged.jpg");
    } catch (const Error& error) {
      in_gray = error.what();
    }
    EXPECT_EQ(in_color, in_gray);
    EXPECT_EQ(picture.luma.data, gray.data);
    num_read += in_color.empty();
  }
  EXPECT_GT(num_read, 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ImagePlanes, testing::ValuesIn(kKinds));

TEST(ImagePlanes, ChromaIsKeptAsStored) {
  const TempDir dir;
  for (const JpegKind& kind : kKinds) {
    if (kind.stored != JCS_YCbCr || kind.luma_x == 3) continue;
    WriteJpeg(dir / "a.jpg", kind, 97, 65);
    const Picture picture = ReadPicture(dir / "a.jpg");
    EXPECT_EQ(1 << picture.chroma_shift_x, kind.luma_x) << kind.name;
    EXPECT_EQ(1 << picture.chroma_shift_y, kind.luma_y) << kind.name;
    EXPECT_EQ(picture.cb.width, (97 + kind.luma_x - 1) / kind.luma_x) << kind.name;
    EXPECT_EQ(picture.cr.height, (65 + kind.luma_y - 1) / kind.luma_y) << kind.name;
  }
}

// What JPEG decoders agree on: two inverse cosine transforms may differ by a level.
TEST(ImagePlanes, OpenCvDecodesTheSameColors) {
  const TempDir dir;
  for (const JpegKind& kind : kKinds) {
    if (kind.stored == JCS_YCCK || kind.luma_x > 2) continue;
    WriteJpeg(dir / "a.jpg", kind, 97, 65);
    cv::Mat oracle =
        cv::imread((dir / "a.jpg").string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    ASSERT_EQ(oracle.cols, 97);
    const ColorImage color = ColorOf(ReadPicture(dir / "a.jpg"));
    for (int y = 0; y < color.height; ++y) {
      for (int x = 0; x < color.width; ++x) {
        const cv::Vec3b bgr = oracle.at<cv::Vec3b>(y, x);
        for (int c = 0; c < 3; ++c) {
          ASSERT_LE(std::abs(color.At(x, y, c) - bgr[2 - c]), 3) << kind.name << x << " " << y;
        }
      }
    }
  }
}

TEST(ImagePlanes, OtherFormatsAreSplit) {
  const TempDir dir;
  ColorImage color(37, 23, 3);
  color.data = SmoothPixels(37, 23, 3);
  for (const char* name : {"a.png", "a.tif", "a.bmp", "a.ppm"}) {
    WriteImage(dir / name, color);
    const Picture picture = ReadPicture(dir / name);
    EXPECT_EQ(picture.luma.data, ReadGrayImage(dir / name).data) << name;
    EXPECT_EQ(picture.cb.width, 37) << name;
    ExpectClose(ColorOf(picture), color, 2, 0.6);
  }
  WriteImage(dir / "g.png", ReadGrayImage(dir / "a.png"));
  EXPECT_FALSE(ReadPicture(dir / "g.png").HasColor());
  for (const char* name : {"a.jpg", "a.webp"}) {
    WriteImage(dir / name, color);
    EXPECT_EQ(ReadPicture(dir / name).luma.data, ReadGrayImage(dir / name).data) << name;
  }
}

}  // namespace
}  // namespace colmap_seapoint
