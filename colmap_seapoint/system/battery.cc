#include "colmap_seapoint/system/battery.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>

#include "colmap_seapoint/base/hold/work_pause.h"
#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// "" where there is no such file.
std::string FirstWord(const fs::path& path) {
  std::string word;
  std::ifstream(path) >> word;
  return word;
}

std::optional<double> Charge(const fs::path& supply) {
  if (FirstWord(supply / "type") != "Battery" || FirstWord(supply / "scope") == "Device") {
    return std::nullopt;
  }
  const std::string capacity = FirstWord(supply / "capacity");
  char* end = nullptr;
  const double percent = std::strtod(capacity.c_str(), &end);
  if (capacity.empty() || *end != 0 || !std::isfinite(percent)) return std::nullopt;
  return percent;
}

std::string PercentText(double percent) { return std::to_string(std::lround(percent)) + " %"; }

}  // namespace

fs::path PowerSupplyFolder() {
  const char* given = std::getenv("SEAPOINT_POWER_SUPPLY");
  return given != nullptr ? given : "/sys/class/power_supply";
}

std::optional<Battery> ReadBattery(const fs::path& power_supply) {
  Battery battery;
  int count = 0;
  bool is_discharging = false, is_charging = false;
  std::error_code error;
  for (fs::directory_iterator entry(power_supply, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto percent = Charge(entry->path());
    if (!percent) continue;
    ++count;
    battery.percent += *percent;
    const std::string status = FirstWord(entry->path() / "status");
    is_discharging = is_discharging || status == "Discharging";
    is_charging = is_charging || status == "Charging";
  }
  if (count == 0) return std::nullopt;
  battery.percent /= count;
  battery.is_drained = is_discharging && !is_charging;
  return battery;
}

BatteryGuard::BatteryGuard(double percent, double seconds_between_looks) {
  if (!(percent > 0)) return;
  try {
    thread_ = std::thread([=] { Watch(percent, seconds_between_looks); });
  } catch (const std::system_error&) {
    LogWarning("The battery is not watched: the system gives no thread for it");
  }
}

BatteryGuard::~BatteryGuard() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  ended_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BatteryGuard::Watch(double percent, double seconds_between_looks) {
  const fs::path folder = PowerSupplyFolder();
  const std::chrono::duration<double> pause(seconds_between_looks);
  bool is_paused = false;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!is_over_) {
    const auto battery = ReadBattery(folder);
    const bool is_low = battery && battery->is_drained && battery->percent <= percent;
    if (is_low && !is_paused) {
      LogWarning("The battery holds " + PercentText(battery->percent) + ": work pauses until the " +
                 "machine is on mains (--pause_on_battery " + PercentText(percent) + ")");
    }
    if (!is_low && is_paused) LogInfo("The machine has power again: work goes on");
    if (is_low != is_paused) SetWorkPaused(PauseReason::kBattery, is_low);
    is_paused = is_low;
    ended_.wait_for(lock, pause, [this] { return is_over_; });
  }
  if (is_paused) SetWorkPaused(PauseReason::kBattery, false);
}

}  // namespace colmap_seapoint
