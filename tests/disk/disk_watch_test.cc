#include "colmap_seapoint/disk/disk_watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/hold/work_pause.h"
#include "tests/disk/told_disk.h"

namespace colmap_seapoint {
namespace {

constexpr uint64_t kMegabyte = 1 << 20;

using std::chrono::milliseconds;

class DiskWatchTest : public testing::Test {
 protected:
  DiskWatchTest() : disk_(folder_.Path()) {}

  std::vector<DiskNeed> ToCome() const { return {{{folder_ / "later"}, 1000 * kMegabyte}}; }
  // Whose removal leaves so many megabytes free.
  SpareData Spare(const std::string& name, uint64_t free_megabytes) {
    return {name, folder_.Path(), [=] {
              removed_ += name;
              SetFree(free_megabytes);
            }};
  }
  void SetFree(uint64_t megabytes) const { disk_.SetFree(megabytes * kMegabyte); }
  // Within five seconds.
  template <typename Condition>
  static bool Comes(const Condition& condition) {
    for (int i = 0; i < 500 && !condition(); ++i) std::this_thread::sleep_for(milliseconds(10));
    return condition();
  }
  static std::string StoppedWhy() {
    try {
      WaitWhilePaused();
    } catch (const WorkStopped& stopped) {
      return stopped.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  ToldDisk disk_;
  std::string removed_;
};

TEST_F(DiskWatchTest, RemovesInOrderAndNoMoreThanItTakes) {
  SetFree(2000);
  DiskWatch watch(WhenShort::kStop, 0.01);
  watch.Begin(ToCome(), {Spare("a", 400), Spare("b", 1000), Spare("c", 5000)});
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(removed_, "");
  testing::internal::CaptureStderr();
  SetFree(200);
  EXPECT_TRUE(Comes([&] { return removed_ == "ab"; }));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(removed_, "ab");
  EXPECT_FALSE(IsWorkHeld());
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_NE(log.find("room is short: removed a, 200 MB"), std::string::npos) << log;
  EXPECT_NE(log.find("room is short: removed b, 600 MB"), std::string::npos) << log;
}

TEST_F(DiskWatchTest, WhatCannotBeRemovedIsPassedOver) {
  SetFree(100);
  const SpareData stubborn = {"x", folder_.Path(), [] { throw Error("x", "is held", "end it"); }};
  DiskWatch watch(WhenShort::kStop, 60);
  watch.Begin(ToCome(), {stubborn, Spare("b", 1000)});
  EXPECT_EQ(removed_, "b");
}

TEST_F(DiskWatchTest, StopsWorkThatIsUnderWay) {
  SetFree(2000);
  {
    DiskWatch watch(WhenShort::kStop, 0.01);
    watch.Begin(ToCome(), {});
    SetFree(299);
    EXPECT_TRUE(Comes([] { return IsWorkHeld(); }));
    const std::string why = StoppedWhy();
    EXPECT_NE(why.find("has 299 MB free, and what is left of this job takes up to 1000 MB"),
              std::string::npos)
        << why;
    EXPECT_NE(why.find("the same command goes on from there"), std::string::npos) << why;
    SetFree(2000);  // too late for work of which a part has ended
    std::this_thread::sleep_for(milliseconds(50));
    EXPECT_THROW(WaitWhilePaused(), WorkStopped);
  }
  EXPECT_FALSE(IsWorkHeld());
}

TEST_F(DiskWatchTest, StopsBeforeAStage) {
  SetFree(299);
  DiskWatch watch(WhenShort::kStop, 60);
  EXPECT_THROW(watch.Begin(ToCome(), {}), WorkStopped);
}

// What this job writes itself is what was expected.
TEST_F(DiskWatchTest, OwnFilesAreNoShortage) {
  SetFree(1000);
  DiskWatch watch(WhenShort::kStop, 0.01);
  watch.Begin(ToCome(), {Spare("a", 2000)});
  std::filesystem::create_directories(folder_ / "later");
  WriteBytes(folder_ / "later" / "cloud", "");
  std::filesystem::resize_file(folder_ / "later" / "cloud", 900 * kMegabyte);
  SetFree(100);
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_EQ(removed_, "");
  EXPECT_FALSE(IsWorkHeld());
}

TEST_F(DiskWatchTest, PausesUntilThereIsRoom) {
  SetFree(299);
  DiskWatch watch(WhenShort::kPause, 0.01);
  const auto begin = std::chrono::steady_clock::now();
  std::thread mending([&] {
    std::this_thread::sleep_for(milliseconds(100));
    SetFree(300);
  });
  testing::internal::CaptureStderr();
  watch.Begin(ToCome(), {});
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(100));
  EXPECT_NE(log.find("Work pauses until there is room"), std::string::npos) << log;
  EXPECT_NE(log.find("work goes on"), std::string::npos) << log;
  mending.join();
  SetFree(0);
  EXPECT_TRUE(Comes([] { return IsWorkHeld(); }));
  watch.Begin({}, {});  // nothing more is to come
  EXPECT_FALSE(IsWorkHeld());
}

TEST_F(DiskWatchTest, WarnsOnceWhereItMayBeFilled) {
  SetFree(500);
  testing::internal::CaptureStderr();
  {
    DiskWatch watch(WhenShort::kWarn, 0.01);
    watch.Begin(ToCome(), {});
    SetFree(5);
    std::this_thread::sleep_for(milliseconds(50));
    watch.Begin(ToCome(), {});
    EXPECT_FALSE(IsWorkHeld());
  }
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_EQ(log.find("warning: "), log.rfind("warning: ")) << log;
  EXPECT_NE(log.find("has 500 MB free"), std::string::npos) << log;
}

}  // namespace
}  // namespace colmap_seapoint
