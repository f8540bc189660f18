#include "colmap_seapoint/system/battery.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

class BatteryTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("battery_" + std::string(test->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    setenv("SEAPOINT_POWER_SUPPLY", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("SEAPOINT_POWER_SUPPLY");
    fs::remove_all(folder_);
  }

  // As the kernel shows one.
  void Supply(const std::string& name, const std::string& type, const std::string& capacity,
              const std::string& status, const std::string& scope = "") const {
    fs::create_directories(folder_ / name);
    std::ofstream(folder_ / name / "type") << type << "\n";
    if (!capacity.empty()) std::ofstream(folder_ / name / "capacity") << capacity << "\n";
    if (!status.empty()) std::ofstream(folder_ / name / "status") << status << "\n";
    if (!scope.empty()) std::ofstream(folder_ / name / "scope") << scope << "\n";
  }

  fs::path folder_;
};

TEST_F(BatteryTest, ThereMayBeNone) {
  EXPECT_FALSE(ReadBattery(folder_ / "nowhere"));
  Supply("AC", "Mains", "", "");
  Supply("mouse", "Battery", "5", "Discharging", "Device");
  Supply("odd", "Battery", "unknown", "Discharging");
  EXPECT_FALSE(ReadBattery(folder_));
}

TEST_F(BatteryTest, IsTheMeanOfSeveral) {
  Supply("BAT0", "Battery", "10", "Discharging");
  Supply("BAT1", "Battery", "30", "Not charging");
  EXPECT_EQ(ReadBattery(folder_)->percent, 20);
  EXPECT_TRUE(ReadBattery(folder_)->is_drained);
  Supply("BAT1", "Battery", "30", "Charging");
  EXPECT_FALSE(ReadBattery(folder_)->is_drained);
}

// Work that runs beside the guard, and how much of it is done.
class CountingWork {
 public:
  CountingWork()
      : thread_([this] {
          ParallelFor(2, 1'000'000, [this](int64_t) {
            if (is_over_) return;
            ++count_;
            std::this_thread::sleep_for(milliseconds(1));
          });
        }) {}
  ~CountingWork() {
    is_over_ = true;
    thread_.join();
  }
  // Within five seconds.
  bool GoesOn() const {
    const int before = count_;
    for (int i = 0; i < 500 && count_ < before + 5; ++i) {
      std::this_thread::sleep_for(milliseconds(10));
    }
    return count_ >= before + 5;
  }
  // For a fifth of a second, within five.
  bool Stands() const {
    for (int i = 0; i < 25; ++i) {
      const int before = count_;
      std::this_thread::sleep_for(milliseconds(200));
      if (count_ == before) return true;
    }
    return false;
  }

 private:
  std::atomic<int> count_{0};
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

TEST_F(BatteryTest, WorkPausesAndGoesOn) {
  Supply("BAT0", "Battery", "50", "Discharging");
  CountingWork work;
  const BatteryGuard guard(20, 0.02);
  EXPECT_TRUE(work.GoesOn());
  Supply("BAT0", "Battery", "20", "Discharging");
  EXPECT_TRUE(work.Stands());
  Supply("BAT0", "Battery", "20", "Charging");
  EXPECT_TRUE(work.GoesOn());
  Supply("BAT0", "Battery", "19", "Discharging");
  EXPECT_TRUE(work.Stands());
  fs::remove_all(folder_ / "BAT0");
  EXPECT_TRUE(work.GoesOn());
}

TEST_F(BatteryTest, TheEndOfTheGuardEndsThePause) {
  Supply("BAT0", "Battery", "5", "Discharging");
  CountingWork work;
  {
    const BatteryGuard guard(20, 0.02);
    EXPECT_TRUE(work.Stands());
  }
  EXPECT_TRUE(work.GoesOn());
  const BatteryGuard never(0, 0.02);
  EXPECT_TRUE(work.GoesOn());
  EXPECT_FALSE(work.Stands());
}

}  // namespace
}  // namespace colmap_seapoint
