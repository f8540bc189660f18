#include "colmap_seapoint/io/raster/map_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/png_rows.h"
#include "colmap_seapoint/io/raster/raster_writer.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr double kPi = 3.14159265358979323846;

// A plane that rises by `right` and `up` a pixel.
FloatImage Plane(int width, int height, double right, double up) {
  FloatImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.At(x, y) = static_cast<float>(right * x - up * y);
  }
  return image;
}

std::vector<uint8_t> Shade(const FloatImage& heights, int y, double pixel_size = 1,
                           const HillshadeLight& light = {}) {
  std::vector<uint8_t> result(2 * static_cast<size_t>(heights.width));
  ShadeRow(y > 0 ? heights.Row(y - 1) : nullptr, heights.Row(y),
           y + 1 < heights.height ? heights.Row(y + 1) : nullptr, heights.width, pixel_size, light,
           result.data());
  return result;
}

// The cosine between a plane's normal and the light, by vectors.
int ExpectedShade(double right, double up, const HillshadeLight& light) {
  const double a = light.azimuth_deg * kPi / 180, e = light.elevation_deg * kPi / 180;
  const double to_light[3] = {std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
  const double normal[3] = {-right, -up, 1};
  const double length = std::sqrt(right * right + up * up + 1);
  double dot = 0;
  for (int i = 0; i < 3; ++i) dot += to_light[i] * normal[i] / length;
  return static_cast<int>(std::lround(1 + 254 * std::max(0.0, dot)));
}

TEST(Hillshade, PlanesAreExactUpToTheEdges) {
  const HillshadeLight lights[] = {{315, 45}, {90, 30}, {180, 80}};
  const double slopes[][2] = {{0, 0}, {0.5, 0}, {0, 0.5}, {-0.7, 0.3}, {3, -3}};
  for (const HillshadeLight& light : lights) {
    for (const auto& slope : slopes) {
      const FloatImage plane = Plane(7, 5, slope[0] * 0.25, slope[1] * 0.25);
      for (int y = 0; y < plane.height; ++y) {
        const auto shades = Shade(plane, y, 0.25, light);
        for (size_t x = 0; x < 7; ++x) {
          EXPECT_NEAR(shades[2 * x], ExpectedShade(slope[0], slope[1], light), 1) << x << " " << y;
          EXPECT_EQ(shades[2 * x + 1], 255);
        }
      }
    }
  }
}

TEST(Hillshade, LightFromTheUpperLeftMakesSlopesThatFaceItBright) {
  const auto facing = Shade(Plane(5, 5, 0.5, -0.5), 2), averted = Shade(Plane(5, 5, -0.5, 0.5), 2);
  EXPECT_GT(facing[4], 220);
  EXPECT_LT(averted[4], 80);
}

TEST(Hillshade, HolesAreTransparentAndTheirEdgesNoCliffs) {
  FloatImage plane = Plane(9, 9, 0.3, 0.1);
  plane.At(4, 4) = kNone;
  plane.At(5, 4) = kNone;
  const auto row = Shade(plane, 4);
  EXPECT_EQ(row[8], 0);
  EXPECT_EQ(row[9], 0);
  for (const int y : {3, 4, 5}) {
    const auto shades = Shade(plane, y);
    for (const size_t x : {3, 6}) {
      EXPECT_NEAR(shades[2 * x], ExpectedShade(0.3, 0.1, {}), 1) << x << " " << y;
    }
  }
}

TEST(Hillshade, LonelyPixelIsLevel) {
  FloatImage image(1, 1);
  EXPECT_EQ(Shade(image, 0)[0], ExpectedShade(0, 0, {}));
}

RasterLayout Layout(RasterBands bands, int width, int height) {
  RasterLayout layout;
  layout.bands = bands;
  layout.width = width;
  layout.height = height;
  layout.tile_size = 512;
  layout.min_x = 10;
  layout.max_y = 20;
  layout.pixel_size = 0.5;
  return layout;
}

void WriteDem(const std::filesystem::path& path, int width, int height) {
  RasterLayout layout = Layout(RasterBands::kFloat32, width, height);
  layout.nodata = -9999;
  RasterWriter writer(path, layout);
  for (int row = 0; row < NumTileRows(layout); ++row) {
    for (int column = 0; column < NumTileColumns(layout); ++column) {
      const RasterWindow window = TileWindow(layout, column, row);
      FloatImage tile(window.width, window.height);
      for (int y = 0; y < window.height; ++y) {
        for (int x = 0; x < window.width; ++x) {
          tile.At(x, y) = window.x + x < 100 ? -9999 : 0.25f * static_cast<float>(window.x + x);
        }
      }
      writer.WriteTile(column, row, tile);
    }
  }
  writer.Finish();
}

// Grey and alpha of a PNG, as another decoder sees them.
cv::Mat ReadPng(const std::filesystem::path& path) {
  return cv::imread(path.string(), cv::IMREAD_UNCHANGED);
}

TEST(MapPictures, HillshadeIsOfTheMapAndOfItsOverviewWhereThatIsTooLarge) {
  const TempDir dir;
  WriteDem(dir / "dem.tif", 900, 700);
  const int expected = ExpectedShade(0.5, 0, {});
  for (const int max_side : {16384, 500}) {
    const int scale = max_side == 500 ? 2 : 1;
    WriteHillshade(dir / "dem.tif", dir / "hillshade.png", max_side);
    const cv::Mat shade = ReadPng(dir / "hillshade.png");
    ASSERT_EQ(shade.cols, 900 / scale);
    ASSERT_EQ(shade.rows, 700 / scale);
    ASSERT_EQ(shade.channels(), 4);  // as OpenCV expands grey and alpha
    int num_wrong = 0;
    for (int y = 0; y < shade.rows; ++y) {
      for (int x = 0; x < shade.cols; ++x) {
        const auto pixel = shade.at<cv::Vec4b>(y, x);
        const bool is_none = x < 100 / scale;
        num_wrong += pixel[3] != (is_none ? 0 : 255) ? 1 : 0;
        num_wrong += !is_none && std::abs(pixel[0] - expected) > 1 ? 1 : 0;
      }
    }
    EXPECT_EQ(num_wrong, 0);
    const std::string world = ReadBytes(dir / "hillshade.pgw");
    EXPECT_EQ(world, scale == 1 ? "0.5\n0\n0\n-0.5\n10.25\n19.75\n" : "1\n0\n0\n-1\n10.5\n19.5\n");
  }
  EXPECT_EQ(MapPictureFiles("hillshade.png"),
            (std::vector<std::string>{"hillshade.png", "hillshade.pgw"}));
}

TEST(MapPictures, PreviewIsSmallAndWhiteWhereNothingIs) {
  const TempDir dir;
  const RasterLayout layout = Layout(RasterBands::kRgba8, 1500, 500);
  RasterWriter writer(dir / "map.tif", layout);
  Image<uint8_t> tile(512, 500, 4);
  for (size_t i = 0; i < tile.data.size(); i += 4) {
    const uint8_t color[] = {180, 60, 20, 255};
    std::copy_n(color, 4, tile.data.begin() + static_cast<std::ptrdiff_t>(i));
  }
  writer.WriteTile(0, 0, tile);
  writer.Finish();
  WritePreview(dir / "map.tif", dir / "map.jpg", 600);
  const ColorImage preview = ReadColorImage(dir / "map.jpg");
  ASSERT_EQ(preview.width, 600);
  ASSERT_EQ(preview.height, 200);
  const int expected[] = {180, 60, 20};
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(preview.At(100, 100, c), expected[c], 4);
    EXPECT_NEAR(preview.At(500, 100, c), 255, 2);
  }
  EXPECT_EQ(ReadBytes(dir / "map.jgw"), "1.25\n0\n0\n-1.25\n10.625\n19.375\n");
  WritePreview(dir / "map.tif", dir / "whole.jpg");
  EXPECT_EQ(ReadColorImage(dir / "whole.jpg").width, 1500);
}

TEST(MapPictures, TheWrongMapIsSaid) {
  const TempDir dir;
  WriteDem(dir / "dem.tif", 100, 100);
  EXPECT_ERROR(WritePreview(dir / "dem.tif", dir / "map.jpg"), "dem.tif: holds no colours");
  EXPECT_ERROR(WriteHillshade(dir / "none.tif", dir / "hillshade.png"), "none.tif: cannot be read");
  EXPECT_FALSE(std::filesystem::exists(dir / "map.jpg"));
}

TEST(PngRows, EveryKindComesBackAndUnfinishedLeavesNothing) {
  const TempDir dir;
  const std::pair<PngColors, int> kinds[] = {
      {PngColors::kGray, 1}, {PngColors::kRgb, 3}, {PngColors::kRgba, 4}};
  for (const auto& [colors, channels] : kinds) {
    PngRows png(dir / "rows.png", 5, 3, colors);
    std::vector<uint8_t> row(static_cast<size_t>(5 * channels));
    for (uint8_t y = 0; y < 3; ++y) {
      for (size_t i = 0; i < row.size(); ++i) row[i] = static_cast<uint8_t>(50 * y + i);
      png.Write(row.data());
    }
    png.Finish();
    const cv::Mat read = ReadPng(dir / "rows.png");
    ASSERT_EQ(read.channels(), channels);
    // OpenCV's order is blue green red.
    const int first = channels == 1 ? 0 : 2;
    EXPECT_EQ(read.ptr(2)[4 * channels], 100 + 4 * channels + first);
  }
  {
    PngRows png(dir / "gone.png", 5, 3, PngColors::kGray);
    const uint8_t row[5] = {};
    png.Write(row);
    EXPECT_ERROR(png.Finish(), "gone.png: cannot be made a PNG of");
  }
  EXPECT_FALSE(std::filesystem::exists(dir / "gone.png"));
  EXPECT_ERROR(PngRows(dir / "none/gone.png", 5, 3, PngColors::kGray), "create the folder first");
}

}  // namespace
}  // namespace colmap_seapoint
