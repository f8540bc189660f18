#include "colmap_seapoint/navigation/log_positions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kNoon = 1714564800;  // 2024-05-01 12:00:00

Eigen::Vector3d Swim(double seconds) {
  return {8 * std::sin(0.05 * seconds), 5 * std::sin(0.081 * seconds + 1), -5 - 0.01 * seconds};
}

std::vector<TimedPicture> Pictures(double start, bool is_absolute = true) {
  std::vector<TimedPicture> pictures;
  for (int i = 0; i < 60; ++i) {
    pictures.push_back(
        {"p" + std::to_string(i) + ".jpg", {start + 3 * i, is_absolute}, 0.5 * Swim(3 * i)});
  }
  return pictures;
}

NavLog Log(double start, bool is_absolute = true) {
  NavLog log;
  log.is_absolute = is_absolute;
  log.has_height = true;
  for (int i = -100; i < 400; ++i) log.fixes.push_back({start + i, Swim(i)});
  return log;
}

TEST(LogPositionsTest, PlacesOfThePictures) {
  const LogPositions found = PlaceByLog(Pictures(kNoon), Log(kNoon + 34.8), {});
  EXPECT_EQ(found.problem, "");
  EXPECT_NEAR(found.offset.seconds, 34.8, 0.1);
  EXPECT_NE(found.text.find("its clock is 34.8 s ahead of the camera's"), std::string::npos)
      << found.text;
  ASSERT_EQ(found.positions.positions.size(), 60u);
  EXPECT_LT((found.positions.positions.at("p7.jpg") - Swim(21)).norm(), 0.1);
}

TEST(LogPositionsTest, AnotherTimeZone) {
  const LogPositions found = PlaceByLog(Pictures(kNoon), Log(kNoon - 2 * 3600 - 7.5), {});
  EXPECT_EQ(found.problem, "");
  EXPECT_NEAR(found.offset.seconds, -7207.5, 0.1);
  EXPECT_NE(found.text.find("2 h 0 min 7.5 s behind the camera's"), std::string::npos)
      << found.text;
  EXPECT_NE(found.text.find("time zone"), std::string::npos);
}

TEST(LogPositionsTest, OnlyOneKnowsTheDate) {
  const LogPositions found = PlaceByLog(Pictures(0, false), Log(kNoon), {});
  EXPECT_EQ(found.problem, "");
  EXPECT_NEAR(found.offset.seconds, kNoon, 0.1);
}

TEST(LogPositionsTest, ALogOfAnotherDay) {
  const LogPositions found = PlaceByLog(Pictures(kNoon), Log(kNoon + 3 * 86400), {});
  EXPECT_NE(found.problem.find("is of another time: it goes from 2024-05-04"), std::string::npos)
      << found.problem;
  EXPECT_NE(found.problem.find("the pictures from 2024-05-01 12:00:00"), std::string::npos);
}

TEST(LogPositionsTest, AStraightTrackIsSaidToTellNothing) {
  std::vector<TimedPicture> pictures = Pictures(kNoon);
  NavLog log = Log(kNoon);
  for (auto& picture : pictures) picture.in_model = {picture.time.seconds - kNoon, 0, 0};
  for (auto& fix : log.fixes) fix.position = {0.3 * (fix.seconds - kNoon), 0, -5};
  const LogPositions found = PlaceByLog(pictures, log, {});
  EXPECT_EQ(found.problem, "");
  EXPECT_FALSE(found.offset.is_determined);
  EXPECT_NE(found.text.find("cannot be determined"), std::string::npos) << found.text;
  EXPECT_LT((found.positions.positions.at("p0.jpg") - Eigen::Vector3d(0, 0, -5)).norm(), 1e-6);
}

TEST(LogPositionsTest, AGivenOffsetIsTaken) {
  LogClockOptions options;
  options.known_offset = 10;
  const LogPositions found = PlaceByLog(Pictures(kNoon), Log(kNoon + 10), options);
  EXPECT_LT((found.positions.positions.at("p7.jpg") - Swim(21)).norm(), 1e-6);
  options.known_offset = 1e6;
  EXPECT_NE(PlaceByLog(Pictures(kNoon), Log(kNoon + 10), options).problem, "");
}

TEST(LogPositionsTest, NoPictures) { EXPECT_NE(PlaceByLog({}, Log(kNoon), {}).problem, ""); }

}  // namespace
}  // namespace colmap_seapoint
