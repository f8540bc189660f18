#include "colmap_seapoint/base/progress.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

// What appears on stderr, which is no terminal here, at that level.
std::string Printed(LogLevel level, const std::function<void()>& print) {
  const LogLevel before = GetLogLevel();
  SetLogLevel(level);
  testing::internal::CaptureStderr();
  print();
  SetLogLevel(before);
  return testing::internal::GetCapturedStderr();
}

void LogOneOfEach() {
  LogError("e");
  LogWarning("w");
  LogInfo("i");
  LogDebug("d");
}

TEST(DurationText, IsShort) {
  EXPECT_EQ(DurationText(0.04), "0.0 s");
  EXPECT_EQ(DurationText(9.94), "9.9 s");
  EXPECT_EQ(DurationText(42.4), "42 s");
  EXPECT_EQ(DurationText(59.6), "1 min 00 s");
  EXPECT_EQ(DurationText(185), "3 min 05 s");
  EXPECT_EQ(DurationText(2 * 3600 + 7 * 60 + 59), "2 h 07 min");
  EXPECT_EQ(DurationText(std::nan("")), "0 s");
  EXPECT_EQ(DurationText(std::numeric_limits<double>::infinity()), "0 s");
}

TEST(Log, EachLevelAndThoseBelow) {
  EXPECT_EQ(Printed(LogLevel::kError, LogOneOfEach), "error: e\n");
  EXPECT_EQ(Printed(LogLevel::kWarning, LogOneOfEach), "error: e\nwarning: w\n");
  EXPECT_EQ(Printed(LogLevel::kInfo, LogOneOfEach), "error: e\nwarning: w\ni\n");
  EXPECT_EQ(Printed(LogLevel::kDebug, LogOneOfEach), "error: e\nwarning: w\ni\ndebug: d\n");
}

TEST(Log, LinesOfSeveralThreadsStayWhole) {
  const std::string line(200, 'x');
  const std::string printed =
      Printed(LogLevel::kInfo, [&] { ParallelFor(4, 50, [&](int64_t) { LogInfo(line); }); });
  std::string expected;
  for (int i = 0; i < 50; ++i) expected += line + "\n";
  EXPECT_EQ(printed, expected);
}

TEST(Progress, WithoutATerminalASingleLineAtTheEndOfAShortJob) {
  const std::string printed = Printed(LogLevel::kInfo, [] {
    Progress progress("Pictures", 3);
    for (int64_t done = 1; done <= 3; ++done) progress.Update(done);
    progress.Finish();
    progress.Finish();
    progress.Update(3);
  });
  EXPECT_EQ(printed, "Pictures: 3 in 0.0 s\n");
}

TEST(Progress, SilentWhereNobodyWantsIt) {
  EXPECT_EQ(Printed(LogLevel::kWarning,
                    [] {
                      Progress progress("Pictures", 3);
                      progress.Update(1);
                      progress.Finish();
                    }),
            "");
  EXPECT_EQ(Printed(LogLevel::kInfo, [] { Progress abandoned("Pictures", 3); }), "");
}

}  // namespace
}  // namespace colmap_seapoint
