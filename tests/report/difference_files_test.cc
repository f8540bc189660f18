#include "colmap_seapoint/report/difference_files.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "colmap_seapoint/compare/nearest.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// Clouds of two points and of one; 0.5 is red, 4 the largest distance that is looked for.
CompareSetup TwoSmallClouds() {
  CompareSetup setup;
  setup.comparison.distances = {0.25, 0.5};
  setup.comparison.max_distance = 4;
  setup.comparison.input.num_points = 2;
  setup.comparison.reference.num_points = 1;
  setup.input_fits_float = setup.reference_fits_float = true;
  setup.view.low = {0, 0, 0};
  setup.view.high = {10, 5, 1};
  return setup;
}

struct Written {
  Eigen::Vector3d xyz;
  std::array<int, 3> rgb;
  float distance;
};

// The points of a file of DistanceCloudWriter in floats: 12 bytes of place, 3 of colour, 4 of
// distance.
std::vector<Written> ReadDistances(const std::filesystem::path& path) {
  const std::string bytes = ReadBytes(path);
  size_t at = bytes.find("end_header\n") + 11;
  std::vector<Written> points;
  for (; at + 19 <= bytes.size(); at += 19) {
    Eigen::Vector3f xyz;
    float distance;
    std::memcpy(xyz.data(), bytes.data() + at, 12);
    std::memcpy(&distance, bytes.data() + at + 15, 4);
    const auto color = [&](size_t i) {
      return static_cast<int>(static_cast<uint8_t>(bytes[at + 12 + i]));
    };
    points.push_back({xyz.cast<double>(), {color(0), color(1), color(2)}, distance});
  }
  EXPECT_EQ(at, bytes.size());
  return points;
}

TEST(DifferenceFilesTest, PointsWithTheirDistancesAndColours) {
  TempDir dir;
  DifferenceFiles files(dir / "differences");
  files.Begin(TwoSmallClouds());
  files.Add(false, {{5, 2, 0}}, {0.25});
  files.Add(true, {{0, 0, 0}}, {0});
  files.Add(true, {{10, 4, 0.5}}, {kBeyond});
  files.Finish();
  const auto input = ReadDistances(dir / "differences" / "input_to_reference.ply");
  ASSERT_EQ(input.size(), 2u);
  EXPECT_EQ(input[0].distance, 0);
  EXPECT_EQ(input[0].rgb, (std::array<int, 3>{0, 0, 127}));  // blue
  EXPECT_EQ(input[1].xyz, Eigen::Vector3d(10, 4, 0.5));
  EXPECT_EQ(input[1].distance, 4);
  EXPECT_EQ(input[1].rgb, (std::array<int, 3>{255, 0, 255}));  // magenta
  const auto reference = ReadDistances(dir / "differences" / "reference_to_input.ply");
  ASSERT_EQ(reference.size(), 1u);
  EXPECT_EQ(reference[0].distance, 0.5f);
  EXPECT_EQ(reference[0].rgb, (std::array<int, 3>{127, 0, 0}));  // red
}

TEST(DifferenceFilesTest, ThePictureShowsTheInputAboveTheReference) {
  TempDir dir;
  DifferenceFiles files(dir / "differences");
  files.Begin(TwoSmallClouds());
  files.Add(true, {{0, 0, 0}, {10, 4, 0}}, {0, kBeyond});
  files.Add(false, {{0, 0, 0}}, {0.25});
  files.Finish();
  const ColorImage picture = ReadColorImage(dir / "differences" / "differences.png");
  EXPECT_EQ(picture.width, 1000);
  EXPECT_EQ(picture.height, 2 * 500 + 2);  // as 5 to 10, and the line between
  EXPECT_EQ(picture.At(0, 0, 2), 127);     // the input's first point, blue
  EXPECT_EQ(picture.At(999, 399, 0), 255);
  EXPECT_EQ(picture.At(0, 502, 0), 127);  // the reference's, red
  EXPECT_EQ(picture.At(0, 502, 2), 0);
  EXPECT_EQ(picture.At(500, 250, 0), 0);
}

TEST(DifferenceFilesTest, NothingAppearsBeforeTheEnd) {
  TempDir dir;
  DifferenceFiles files(dir / "differences");
  files.Begin(TwoSmallClouds());
  files.Add(true, {{0, 0, 0}}, {0});
  EXPECT_FALSE(std::filesystem::exists(dir / "differences" / "input_to_reference.ply"));
  WriteBytes(dir / "file", "x");
  DifferenceFiles nowhere(dir / "file");
  EXPECT_ERROR(nowhere.Begin(TwoSmallClouds()), "file");
}

}  // namespace
}  // namespace colmap_seapoint
