#include "colmap_seapoint/pictures/exif_positions.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

// A picture a metre farther north than the one before.
ReadablePicture At(int i, CaptureHeights heights = {}) {
  ReadablePicture picture;
  picture.name = "p" + std::to_string(i) + ".jpg";
  picture.info.gps = GeoPosition{43.1 + 9e-6 * i, 5.9, 0};
  picture.info.heights = heights;
  return picture;
}

CaptureHeights Altitude(double metres) {
  CaptureHeights heights;
  heights.altitude = metres;
  return heights;
}

TEST(ExifPositions, LatitudeLongitudeAltitude) {
  const ExifPositions found = PositionsFromExif({At(0, Altitude(12)), At(1, Altitude(13))});
  EXPECT_EQ(found.problem, "");
  EXPECT_NE(found.heights.find("GPS altitude"), std::string::npos);
  ASSERT_EQ(found.positions.positions.size(), 2u);
  EXPECT_TRUE(found.positions.is_geographic);
  EXPECT_EQ(found.positions.positions.at("p1.jpg"), Eigen::Vector3d(43.1 + 9e-6, 5.9, 13));
}

TEST(ExifPositions, ZeroZeroIsNoPosition) {
  ReadablePicture nowhere = At(2);
  nowhere.info.gps = GeoPosition{0, 0, 0};
  testing::internal::CaptureStderr();
  const ExifPositions found = PositionsFromExif({At(0), At(1), nowhere});
  EXPECT_NE(testing::internal::GetCapturedStderr().find("latitude 0, longitude 0"),
            std::string::npos);
  EXPECT_EQ(found.positions.positions.count("p2.jpg"), 0u);
  EXPECT_EQ(found.positions.positions.size(), 2u);
}

TEST(ExifPositions, AllInOnePlaceAreNone) {
  std::vector<ReadablePicture> pictures = {At(0), At(1), At(2)};
  for (ReadablePicture& picture : pictures) picture.info.gps = GeoPosition{43.1, 5.9, 0};
  const ExifPositions found = PositionsFromExif(pictures);
  EXPECT_NE(found.problem.find("the same GPS position"), std::string::npos);
  EXPECT_TRUE(found.positions.positions.empty());
}

TEST(ExifPositions, HeightsOfOneKind) {
  CaptureHeights both = Altitude(100);
  both.depth = 7;
  // Depth where as many tell it; else what most tell, and the others are left out.
  EXPECT_EQ(PositionsFromExif({At(0, both), At(1, both)}).positions.positions.at("p0.jpg").z(), -7);
  const ExifPositions mixed =
      PositionsFromExif({At(0, both), At(1, Altitude(101)), At(2, Altitude(102)), At(3)});
  EXPECT_EQ(mixed.positions.positions.size(), 3u);
  EXPECT_EQ(mixed.positions.positions.at("p0.jpg").z(), 100);
  // Hardly any: all are level.
  const ExifPositions level = PositionsFromExif({At(0, both), At(1), At(2), At(3)});
  EXPECT_EQ(level.positions.positions.size(), 4u);
  EXPECT_EQ(level.positions.positions.at("p0.jpg").z(), 0);
  EXPECT_NE(level.heights.find("level"), std::string::npos);
}

TEST(ExifPositions, WithoutGps) {
  ReadablePicture plain;
  plain.name = "a.jpg";
  const ExifPositions found = PositionsFromExif({plain});
  EXPECT_TRUE(found.positions.positions.empty());
  EXPECT_EQ(found.problem, "");
  EXPECT_TRUE(PositionsFromExif({}).positions.positions.empty());
}

TEST(SuggestedCrs, UtmZones) {
  const auto crs_at = [](double latitude, double longitude) {
    PicturePositions positions;
    positions.is_geographic = true;
    positions.positions["a"] = {latitude, longitude, 0};
    return SuggestedCrs(positions);
  };
  EXPECT_EQ(crs_at(43.1, 5.9), "EPSG:32631");
  EXPECT_EQ(crs_at(43.1, 6.1), "EPSG:32632");
  EXPECT_EQ(crs_at(-34.5, 150.9), "EPSG:32756");
  EXPECT_EQ(crs_at(10, -180), "EPSG:32601");
  EXPECT_EQ(crs_at(10, 180), "EPSG:32660");
  EXPECT_EQ(crs_at(10, 359), "EPSG:32630");
  EXPECT_EQ(crs_at(88, 5.9), "");
  EXPECT_EQ(SuggestedCrs({}), "");
}

TEST(TimesFromExif, WithAndWithoutFractions) {
  std::vector<ReadablePicture> pictures = {At(0), At(1), At(2)};
  pictures[0].info.taken = "2024:05:01 12:00:00";
  pictures[1].info.taken = "2024:05:01 12:00:01";
  auto times = TimesFromExif(pictures);
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].time.seconds, 1714564800.5);  // on average
  pictures[1].info.taken = "2024:05:01 12:00:01.25";
  times = TimesFromExif(pictures);
  EXPECT_EQ(times[0].time.seconds, 1714564800);
  EXPECT_EQ(times[1].time.seconds, 1714564801.25);
  EXPECT_TRUE(TimesFromExif({}).empty());
}

}  // namespace
}  // namespace colmap_seapoint
