#include "colmap_seapoint/rendering/render_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/compare/plan_view.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/rendering/legend.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// A plane of 2 x 1, all white; 1 point in 100 lies a hundred times as far away.
class RenderCloud : public testing::Test {
 protected:
  void SetUp() override {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 20200\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    const std::string rest = " 0 0 1 255 255 255\n";
    for (int i = 0; i < 20000; ++i) {
      text += std::to_string(0.01 * (i % 200)) + " " + std::to_string(0.01 * (i / 200)) + " " +
              std::to_string(0.001 * (i % 7)) + rest;
    }
    for (int i = 0; i < 200; ++i)
      text += std::to_string(i) + " " + std::to_string(2 * i) + " 50" + rest;
    WriteTextFile(options_.input_path, text);
  }
  TempDir folder_;
  CloudRendererOptions options_ = [this] {
    CloudRendererOptions options;
    options.input_path = (folder_ / "cloud.ply").string();
    options.output_path = (folder_ / "cloud.png").string();
    options.width = 200;
    return options;
  }();
};

TEST_F(RenderCloud, FloatersDoNotMakeThePictureBlack) {
  RunCloudRenderer(options_);
  const ColorImage picture = ReadColorImage(options_.output_path);
  EXPECT_EQ(picture.width, 200);
  // Colours above, heights below, legend at the foot: the upper half is the plane, but for the
  // margin.
  int num_white = 0;
  const int rows = 100;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < picture.width; ++x) num_white += picture.At(x, y, 0) > 250 ? 1 : 0;
  }
  EXPECT_GT(num_white, 200 * rows / 2);
}

TEST_F(RenderCloud, NeverReplacesAFile) {
  RunCloudRenderer(options_);
  EXPECT_THROW(RunCloudRenderer(options_), Error);
}

TEST_F(RenderCloud, ARangeOrAPictureNeedsAModel) {
  options_.max_range = 3;
  EXPECT_THROW(RunCloudRenderer(options_), UsageError);
  options_.max_range = 0;
  options_.image_name = "a.jpg";
  EXPECT_THROW(RunCloudRenderer(options_), UsageError);
}

TEST(RoundLength, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(RoundLength(0.73), 0.5);
  EXPECT_DOUBLE_EQ(RoundLength(4.9), 2);
  EXPECT_DOUBLE_EQ(RoundLength(1000), 1000);
  EXPECT_EQ(RoundLength(0), 0);
  EXPECT_EQ(RoundLength(-1), 0);
  EXPECT_EQ(LengthText(0.5, "m"), "0.5 m");
}

TEST(Legend, TinyPicturesAndOddScalesAreLeftAlone) {
  ColorImage tiny(3, 2, 3);
  DrawScaleBar(1, "m", &tiny);
  ColorImage picture(200, 100, 3);
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL}) DrawScaleBar(scale, "m", &picture);
  for (const uint8_t value : picture.data) EXPECT_EQ(value, 0);
  DrawScaleBar(40, "m", &picture);  // 40 pixels: 1 m
  EXPECT_EQ(picture.At(30, 85, 0), 255);
  EXPECT_EQ(picture.At(60, 85, 0), 0);
  EXPECT_EQ(RampLegend(1, 0, 1, "m").width, 1);
}

}  // namespace
}  // namespace colmap_seapoint
