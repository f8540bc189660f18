// A laptop's battery: work waits while it runs low, so that the night's data are not lost with it.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

namespace colmap_seapoint {

struct Battery {
  double percent = 0;       // of its charge; of several, the mean
  bool is_drained = false;  // it is discharging, and no other one is charged
};

// Where the kernel tells of batteries, or the folder that the environment variable
// SEAPOINT_POWER_SUPPLY names in place of it.
std::filesystem::path PowerSupplyFolder();
// nullopt where there is none. Those of mice and headsets do not count.
std::optional<Battery> ReadBattery(const std::filesystem::path& power_supply);

// While it lives, all work pauses (base/hold/work_pause.h) as long as the battery is drained and
// holds no more than `percent`, and says so; it goes on by itself once the machine is on mains, or
// the battery holds more. 0 percent, or no battery: nothing ever happens.
class BatteryGuard {
 public:
  explicit BatteryGuard(double percent, double seconds_between_looks = 5);
  ~BatteryGuard();
  BatteryGuard(const BatteryGuard&) = delete;
  BatteryGuard& operator=(const BatteryGuard&) = delete;

 private:
  void Watch(double percent, double seconds_between_looks);

  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace colmap_seapoint
