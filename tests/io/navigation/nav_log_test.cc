#include "colmap_seapoint/io/navigation/nav_log.h"

#include <gtest/gtest.h>

#include "tests/expect_error.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

constexpr double kNoon = 1714564800;  // 2024-05-01 12:00:00

TEST(ClockTimes, Written) {
  const auto absolute = [](const std::string& text) {
    const auto time = ParseClockTime(text);
    return time && time->is_absolute ? time->seconds : -1;
  };
  EXPECT_EQ(absolute("2024-05-01T12:00:00Z"), kNoon);
  EXPECT_EQ(absolute("2024-05-01 12:00:00"), kNoon);
  EXPECT_EQ(absolute("2024/05/01 12:00:00.25"), kNoon + 0.25);
  EXPECT_EQ(absolute("2024:05:01 12:00:00"), kNoon);
  EXPECT_EQ(absolute("2024-05-01T14:00:00+02:00"), kNoon);
  EXPECT_EQ(absolute("2024-05-01T07:30:00-0430"), kNoon);
  EXPECT_EQ(absolute("1714564800.5"), kNoon + 0.5);
  EXPECT_EQ(absolute("1714564800500"), kNoon + 0.5);
  EXPECT_EQ(absolute("2024-02-29T00:00:00Z"), 1709164800);
  EXPECT_EQ(ParseClockTime("12.5")->seconds, 12.5);
  EXPECT_FALSE(ParseClockTime("12.5")->is_absolute);
  EXPECT_EQ(ParseClockTime("01:02:03.5")->seconds, 3723.5);
  for (const char* text : {"", "noon", "2024-05-01", "2024-13-01 00:00:00", "2024-05-01 12:00",
                           "12:61:00", "2024-05-01T12:00:00 soon", "nan"}) {
    EXPECT_FALSE(ParseClockTime(text)) << text;
  }
  EXPECT_EQ(ClockTimeText({kNoon + 3661.9, true}), "2024-05-01 13:01:01");
  EXPECT_EQ(ClockTimeText({12.34, false}), "12.3 s");
}

class NavLogs : public testing::Test {
 protected:
  NavLog Read(const std::string& text) {
    WriteBytes(dir_ / "log.csv", text);
    return ReadNavLogs((dir_ / "log.csv").string(), "--nav");
  }
  TempDir dir_;
};

TEST_F(NavLogs, ColumnsByTheirNames) {
  const NavLog geographic = Read(
      "Heading,Depth (m),Latitude_deg,Longitude [deg],Timestamp_UTC\n"
      "10,3,43.2,5.9,2024-05-01T12:00:01Z\n10,2.5,43.1,5.8,2024-05-01T12:00:00Z\n");
  EXPECT_TRUE(geographic.is_geographic);
  EXPECT_TRUE(geographic.is_absolute);
  EXPECT_TRUE(geographic.has_height);
  ASSERT_EQ(geographic.fixes.size(), 2u);
  EXPECT_EQ(geographic.fixes[0].seconds, kNoon);
  EXPECT_EQ(geographic.fixes[0].position, Eigen::Vector3d(43.1, 5.8, -2.5));
  const NavLog metres = Read("t,Easting,Northing\n1,2,3\n0,5,6\n1,9,9\n");
  EXPECT_FALSE(metres.is_geographic);
  EXPECT_FALSE(metres.has_height);
  ASSERT_EQ(metres.fixes.size(), 2u);  // one a time
  EXPECT_EQ(metres.fixes[1].position, Eigen::Vector3d(2, 3, 0));
  // A vehicle's altitude above the ground is no height where there is a depth.
  EXPECT_EQ(Read("time,x,y,altitude,depth\n0,1,1,2,30\n1,1,1,2,31\n").fixes[1].position.z(), -31);
  EXPECT_EQ(
      Read("date,time,x,y\n2024-05-01,12:00:00,1,1\n2024-05-01,12:00:01,1,1\n").fixes[0].seconds,
      kNoon);
}

// As a spreadsheet writes it where decimals have a comma.
TEST_F(NavLogs, SemicolonsAndDecimalCommas) {
  const NavLog log = Read(
      "Zeit;time;lat;lon;depth, m\n"
      ";2024-05-01 12:00:00,25;43,1;+5,75;-3,5\nx;2024-05-01 12:00:01;43;\"5,5\";1e1\n");
  ASSERT_EQ(log.fixes.size(), 2u);
  EXPECT_EQ(log.fixes[0].seconds, kNoon + 0.25);
  EXPECT_EQ(log.fixes[0].position, Eigen::Vector3d(43.1, 5.75, 3.5));
  EXPECT_EQ(log.fixes[1].position, Eigen::Vector3d(43, 5.5, -10));
  const NavLog tabs = Read("name\ttime\tx\ty\n\t0\t1,5\t2\na,b\t1\t1.5\t-2,25\n");
  ASSERT_EQ(tabs.fixes.size(), 2u);  // an empty first field is one
  EXPECT_EQ(tabs.fixes[1].position, Eigen::Vector3d(1.5, -2.25, 0));
}

TEST_F(NavLogs, RowsWithoutAFixAreSkippedAndCounted) {
  testing::internal::CaptureStderr();
  const NavLog log = Read(
      "time,lat,lon,depth\n0,43,5,1\n1,,,1\n2,nan,5,1\n3,0,0,1\n,43,5,1\n4,43,5\n5,43,5,2\n6,95,5,"
      "1\n");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("6 of 8 rows"), std::string::npos);
  EXPECT_EQ(log.fixes.size(), 2u);
}

TEST_F(NavLogs, Errors) {
  EXPECT_ERROR(Read(""), "is empty");
  EXPECT_ERROR(Read("lat,lon\n1,2\n"), "names no time");
  EXPECT_ERROR(Read("time,lat,depth\n1,2,3\n"), "names no position");
  EXPECT_ERROR(Read("time,x,y\n"), "holds 0 rows with a time and a position");
  EXPECT_ERROR(Read("time,x,y\n0,1,1\n2024-05-01T12:00:00Z,1,1\n"), "log.csv:3: its time is of");
  EXPECT_ERROR(ReadNavLogs((dir_ / "none.csv").string(), "--nav"), "check --nav");
}

TEST_F(NavLogs, TwoOneAfterTheOther) {
  const std::string a = (dir_ / "a.csv").string(), b = (dir_ / "b.csv").string();
  WriteBytes(a, "time,x,y\n10,1,1\n11,1,1\n");
  WriteBytes(b, "time,x,y\n0,2,2\n1,2,2\n");
  const NavLog log = ReadNavLogs(a + "," + b, "--nav");
  ASSERT_EQ(log.fixes.size(), 4u);
  EXPECT_EQ(log.fixes.front().seconds, 0);
  WriteBytes(b, "time,x,y\n10.5,2,2\n12,2,2\n");
  EXPECT_ERROR(ReadNavLogs(a + "," + b, "--nav"), "b.csv: overlaps in time");
  WriteBytes(b, "time,lat,lon\n0,2,2\n1,2,2\n");
  EXPECT_ERROR(ReadNavLogs(a + "," + b, "--nav"), "b.csv: tells other things");
}

TEST_F(NavLogs, TimesOfPictures) {
  WriteBytes(dir_ / "t.csv",
             "frame,clip,seconds,overlap\nf1.jpg,a.mp4,0.5,0.8\nf2.jpg,a.mp4,2,1\n");
  const auto times = ReadPictureTimes(dir_ / "t.csv", "--nav_times");
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].image, "f1.jpg");
  EXPECT_EQ(times[1].time.seconds, 2);
  WriteBytes(dir_ / "t.csv", "image,time\nf1.jpg,soon\n");
  EXPECT_ERROR(ReadPictureTimes(dir_ / "t.csv", "--nav_times"), "t.csv:2: 'soon' is no time");
  WriteBytes(dir_ / "t.csv", "image\nf1.jpg\n");
  EXPECT_ERROR(ReadPictureTimes(dir_ / "t.csv", "--nav_times"), "image,time");
}

}  // namespace
}  // namespace colmap_seapoint
