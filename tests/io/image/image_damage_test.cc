// Pictures that are cut, changed or lie about themselves: an Error each, and nothing on stderr.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

ColorImage MakeNoise(int width, int height) {
  ColorImage image(width, height, 3);
  std::mt19937 random(7);
  for (uint8_t& value : image.data) value = static_cast<uint8_t>(random());
  return image;
}

void WriteWith(const std::filesystem::path& path, const std::vector<int>& options) {
  ColorImage noise = MakeNoise(90, 70);
  const cv::Mat mat(noise.height, noise.width, CV_8UC3, noise.data.data());
  ASSERT_TRUE(cv::imwrite(path.string(), mat, options));
}

class ImageDamage : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string name = GetParam();
    const std::vector<int> options =
        name == "progressive.jpg" ? std::vector<int>{cv::IMWRITE_JPEG_PROGRESSIVE, 1}
        : name == "raw.tif"       ? std::vector<int>{cv::IMWRITE_TIFF_COMPRESSION, 1}
                                  : std::vector<int>{};
    WriteWith(dir_ / name, options);
    whole_ = ReadBytes(dir_ / name);
    cut_ = dir_ / ("cut_" + name);
    testing::internal::CaptureStderr();
  }
  void TearDown() override { EXPECT_EQ(testing::internal::GetCapturedStderr(), ""); }

  TempDir dir_;
  std::string whole_;
  std::filesystem::path cut_;
};

TEST_P(ImageDamage, TruncatedAnywhereIsAnError) {
  EXPECT_EQ(ReadGrayImage(dir_ / GetParam()).width, 90);
  std::vector<size_t> sizes;
  for (size_t size = 1; size < whole_.size(); size += 1 + whole_.size() / 40) sizes.push_back(size);
  for (size_t size = whole_.size() - 8; size < whole_.size(); ++size) sizes.push_back(size);
  for (const size_t size : sizes) {
    WriteBytes(cut_, whole_.substr(0, size));
    // The last bytes of a TIFF may be its tags' padding; every pixel is there then.
    const bool is_tiff = whole_[0] == 'I' && whole_[1] == 'I';
    if (is_tiff && size + 8 >= whole_.size()) continue;
    EXPECT_ERROR(ReadGrayImage(cut_), cut_.filename().string());
    EXPECT_ERROR(ReadColorImage(cut_), cut_.filename().string());
  }
}

TEST_P(ImageDamage, ChangedBytesNeverCrash) {
  std::mt19937 random(11);
  for (int i = 0; i < 60; ++i) {
    std::string damaged = whole_;
    const int num_changes = 1 + i % 20;
    const size_t range = i % 2 == 0 ? 200 : damaged.size();
    for (int k = 0; k < num_changes; ++k) {
      damaged[4 + random() % (std::min(range, damaged.size()) - 4)] = static_cast<char>(random());
    }
    WriteBytes(cut_, damaged);
    try {
      const ImageInfo info = ReadImageInfo(cut_);
      const GrayImage gray = ReadGrayImage(cut_);
      EXPECT_EQ(info.width, gray.width);
      EXPECT_EQ(info.height, gray.height);
    } catch (const Error&) {
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageDamage,
                         testing::Values("baseline.jpg", "progressive.jpg", "a.png", "lzw.tif",
                                         "raw.tif", "a.bmp", "a.webp", "a.ppm"));

TEST(ImageDamage, EmptyMissingAndForeignFiles) {
  const TempDir dir;
  WriteBytes(dir / "empty.jpg", "");
  WriteBytes(dir / "text.jpg", "this is no picture");
  for (const auto& read : std::vector<std::function<void(const std::filesystem::path&)>>{
           [](const auto& path) { ReadImageInfo(path); },
           [](const auto& path) { ReadGrayImage(path); },
           [](const auto& path) { ReadColorImage(path); }}) {
    EXPECT_ERROR(read(dir / "empty.jpg"), "is empty");
    EXPECT_ERROR(read(dir / "text.jpg"), "is no picture");
    EXPECT_ERROR(read(dir / "missing.jpg"), "cannot be read");
    EXPECT_ERROR(read(dir.Path()), "");
  }
}

// A header that promises a huge picture must not make anyone allocate it.
TEST(ImageDamage, HugeSizesAreRefused) {
  const TempDir dir;
  WriteBytes(dir / "huge.pgm", "P5\n1000000 1000000\n255\nxxxx");
  EXPECT_ERROR(ReadImageInfo(dir / "huge.pgm"), "is too large: 1000000 x 1000000");
  WriteBytes(dir / "large.pgm", "P5\n30000 30000\n255\nxxxx");
  EXPECT_ERROR(ReadGrayImage(dir / "large.pgm"), "ends too early");
}

// It begins as a WebP does, and has at byte 128 what OpenCV knows DICOM by: none of the many
// formats that OpenCV can hand on is tried.
TEST(ImageDamage, NoOtherDecoderIsTried) {
  const TempDir dir;
  const std::string one = "\1\1\1\1";  // the length, as four bytes, and both sides
  std::string picture = "RIFF" + one + "WEBPVP8 " + one + "no key" + one;
  picture.resize(128, ' ');
  picture += "DICM";
  picture.resize(0x01010101 + 8, ' ');
  WriteBytes(dir / "picture.webp", picture);
  testing::internal::CaptureStderr();
  EXPECT_ERROR(ReadGrayImage(dir / "picture.webp"), "cannot decode it");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ImageDamage, ManyThreadsStaySilent) {
  const TempDir dir;
  const char* const names[] = {"a.jpg", "b.tif", "c.png"};
  for (const char* name : names) {
    WriteImage(dir / name, MakeNoise(50, 40));
    const std::string whole = ReadBytes(dir / name);
    WriteBytes(dir / (std::string("cut_") + name), whole.substr(0, whole.size() / 2));
  }
  testing::internal::CaptureStderr();
  ParallelFor(4, 60, [&](int64_t i) {
    const std::string name = names[i % 3];
    ReadImageInfo(dir / name);
    ReadGrayImage(dir / name);
    EXPECT_ERROR(ReadGrayImage(dir / ("cut_" + name)), "cut_");
  });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace colmap_seapoint
