#include "colmap_seapoint/navigation/clock_offset.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace colmap_seapoint {
namespace {

using Path = std::function<Eigen::Vector3d(double)>;  // seconds -> metres

constexpr double kTruth = 34.8;

// Strips of 20 m, 2 m apart, at 0.4 m/s, without an end.
Eigen::Vector3d Strips(double seconds) {
  const double strip_seconds = 50, turn_seconds = 5;
  const double period = strip_seconds + turn_seconds;
  const double strip = std::floor(seconds / period), within = seconds - strip * period;
  const double along = std::clamp(within / strip_seconds, 0.0, 1.0) * 20;
  const double turn = std::clamp((within - strip_seconds) / turn_seconds, 0.0, 1.0) * 2;
  const bool is_back = static_cast<int64_t>(strip) % 2 != 0;
  return {is_back ? 20 - along : along, 2 * strip + turn, -10};
}

// The same between the dive down to them and the way up.
Eigen::Vector3d Lawnmower(double seconds) {
  const double within = std::clamp(seconds, 85.0, 355.0);
  return Strips(within) + Eigen::Vector3d(0, 0, 0.3 * std::abs(seconds - within));
}

Eigen::Vector3d Straight(double seconds) { return {0.3 * seconds, 0.1 * seconds, -10}; }

// A picture every two seconds from the hundredth second on, in a model of its own frame.
std::vector<TimedCenter> TrackOf(const Path& path, int num_pictures = 120) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()));
  std::vector<TimedCenter> track;
  for (int i = 0; i < num_pictures; ++i) {
    const double seconds = 100 + 2 * i;
    track.push_back({seconds, 0.37 * (turn * path(seconds)) + Eigen::Vector3d(3, 1, 4)});
  }
  return track;
}

// A fix a second, whose clock is ahead by kTruth.
std::vector<LogFix> LogOf(const Path& path, double noise_m, unsigned seed = 1, double until = 500) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0, noise_m > 0 ? noise_m : 1);
  std::vector<LogFix> log;
  for (double seconds = 0; seconds < until; ++seconds) {
    Eigen::Vector3d metres = path(seconds);
    if (noise_m > 0)
      metres += Eigen::Vector3d(noise(generator), noise(generator), noise(generator));
    log.push_back({seconds + kTruth, metres});
  }
  return log;
}

TEST(ClockOffsetTest, FoundWithinHalfASecond) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const ClockOffset found =
        FindClockOffset(TrackOf(Lawnmower), LogOf(Lawnmower, 0.05, seed), {OffsetRange()});
    EXPECT_EQ(found.problem, "");
    EXPECT_TRUE(found.is_determined) << found.low << " to " << found.high;
    EXPECT_NEAR(found.seconds, kTruth, 0.1);
    EXPECT_LE(found.low, kTruth);
    EXPECT_GE(found.high, kTruth);
    EXPECT_NEAR(found.rms_m, 0.05 * std::sqrt(3.0) * 0.8, 0.03);  // between two fixes: less
  }
}

// Strips that go on for ever look the same a strip later, turned over.
TEST(ClockOffsetTest, StripsThatRepeatEachOtherAreSaidToFitSeveralTimes) {
  for (const double noise : {0.0, 0.05}) {
    const ClockOffset found =
        FindClockOffset(TrackOf(Strips), LogOf(Strips, noise), {OffsetRange()});
    EXPECT_FALSE(found.is_determined);
    EXPECT_LE(found.low, kTruth);
    EXPECT_GE(found.high, kTruth);
    ASSERT_GE(found.alternatives.size(), 3u);
    EXPECT_TRUE(std::any_of(found.alternatives.begin(), found.alternatives.end(),
                            [](double seconds) { return std::abs(seconds - kTruth) < 0.2; }));
  }
}

// The log was switched on and off with the camera: a strip later it would not know the last ones.
TEST(ClockOffsetTest, ALogThatPlacesMoreOfThePicturesIsRight) {
  std::vector<LogFix> log = LogOf(Strips, 0.05);
  log.erase(log.begin() + 340, log.end());
  log.erase(log.begin(), log.begin() + 100);
  const ClockOffset found = FindClockOffset(TrackOf(Strips), log, {OffsetRange()});
  EXPECT_TRUE(found.is_determined) << found.low << " to " << found.high;
  EXPECT_NEAR(found.seconds, kTruth, 0.1);
}

TEST(ClockOffsetTest, ExactWithoutNoise) {
  const ClockOffset found =
      FindClockOffset(TrackOf(Lawnmower), LogOf(Lawnmower, 0), {OffsetRange()});
  EXPECT_TRUE(found.is_determined);
  EXPECT_NEAR(found.seconds, kTruth, 0.05);
}

TEST(ClockOffsetTest, AStraightTrackAtConstantSpeedTellsNothing) {
  for (const double noise : {0.0, 0.05, 0.5}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const ClockOffset found =
          FindClockOffset(TrackOf(Straight), LogOf(Straight, noise, seed), {OffsetRange()});
      EXPECT_EQ(found.problem, "");
      EXPECT_FALSE(found.is_determined) << noise << " " << found.low << " to " << found.high;
      EXPECT_LT(found.low, -20);
      EXPECT_GT(found.high, 60);
    }
  }
}

TEST(ClockOffsetTest, ATurnOrAStopTells) {
  const Path stop = [](double seconds) {
    return Straight(seconds < 200 ? seconds : seconds < 230 ? 200 : seconds - 30);
  };
  const Path corner = [](double seconds) {
    return seconds < 220 ? Eigen::Vector3d(0.3 * seconds, 0, -10)
                         : Eigen::Vector3d(66, 0.3 * (seconds - 220), -10);
  };
  for (const Path& path : {stop, corner}) {
    const ClockOffset found = FindClockOffset(TrackOf(path), LogOf(path, 0.05), {OffsetRange()});
    EXPECT_TRUE(found.is_determined) << found.low << " to " << found.high;
    EXPECT_NEAR(found.seconds, kTruth, 0.5);
  }
}

TEST(ClockOffsetTest, JumpsOfTheLogDoNoHarm) {
  std::vector<LogFix> log = LogOf(Lawnmower, 0.05);
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> jump(-60, 60);
  for (size_t i = 3; i < log.size(); i += 12)
    log[i].metres += Eigen::Vector3d(jump(generator), 40, 0);
  const ClockOffset found = FindClockOffset(TrackOf(Lawnmower), log, {OffsetRange()});
  EXPECT_TRUE(found.is_determined) << found.low << " to " << found.high;
  EXPECT_NEAR(found.seconds, kTruth, 0.5);
}

TEST(ClockOffsetTest, GapsLeavePicturesOut) {
  std::vector<LogFix> log = LogOf(Lawnmower, 0.05);
  log.erase(log.begin() + 180, log.begin() + 230);
  const ClockOffset found = FindClockOffset(TrackOf(Lawnmower), log, {OffsetRange()});
  EXPECT_TRUE(found.is_determined);
  EXPECT_NEAR(found.seconds, kTruth, 0.2);
  EXPECT_LT(found.num_placed, 100u);
  EXPECT_GE(found.num_placed, 90u);
}

TEST(ClockOffsetTest, AnotherDivesLogFitsNowhere) {
  const Path other = [](double seconds) {
    return Eigen::Vector3d(10 * std::sin(0.05 * seconds), 6 * std::cos(0.031 * seconds), -3);
  };
  const ClockOffset found =
      FindClockOffset(TrackOf(Lawnmower), LogOf(other, 0.05), {OffsetRange()});
  EXPECT_NE(found.problem.find("fits the cameras' track nowhere"), std::string::npos);
}

TEST(ClockOffsetTest, ALogThatStandsStillFitsNowhere) {
  const Path still = [](double) { return Eigen::Vector3d(1, 2, 3); };
  EXPECT_NE(FindClockOffset(TrackOf(Lawnmower), LogOf(still, 0.05), {OffsetRange()}).problem, "");
  EXPECT_NE(FindClockOffset(TrackOf(Lawnmower), LogOf(still, 0), {OffsetRange()}).problem, "");
  EXPECT_NE(FindClockOffset(TrackOf(still), LogOf(still, 0), {OffsetRange()}).problem, "");
}

TEST(ClockOffsetTest, TooLittle) {
  EXPECT_NE(FindClockOffset({}, LogOf(Lawnmower, 0), {OffsetRange()}).problem, "");
  EXPECT_NE(FindClockOffset(TrackOf(Lawnmower, 5), LogOf(Lawnmower, 0), {OffsetRange()}).problem,
            "");
  EXPECT_NE(FindClockOffset(TrackOf(Lawnmower), {}, {OffsetRange()}).problem, "");
  EXPECT_NE(FindClockOffset(TrackOf(Lawnmower), LogOf(Lawnmower, 0), {}).problem, "");
}

TEST(SortedFixesTest, UnsortedDoubledAndNotFinite) {
  const double nan = std::nan("");
  const auto sorted = SortedFixes(
      {{3, {3, 0, 0}}, {1, {1, 0, 0}}, {nan, {0, 0, 0}}, {2, {nan, 0, 0}}, {3, {9, 0, 0}}});
  ASSERT_EQ(sorted.size(), 2u);
  EXPECT_EQ(sorted[0].seconds, 1);
  EXPECT_EQ(sorted[1].metres.x(), 3);
  EXPECT_EQ(PlaceAt(sorted, 2)->x(), 2);
  EXPECT_EQ(PlaceAt(sorted, 3)->x(), 3);
  EXPECT_FALSE(PlaceAt(sorted, 0.5));
  EXPECT_FALSE(PlaceAt(sorted, 3.5));
  EXPECT_FALSE(PlaceAt({{0, {0, 0, 0}}, {kMaxLogGap + 1, {1, 0, 0}}}, 5));
}

}  // namespace
}  // namespace colmap_seapoint
