#include "colmap_seapoint/disk/disk_watch.h"

#include <chrono>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/hold/quiet_thread.h"
#include "colmap_seapoint/base/hold/work_pause.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/system/free_disk.h"
#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

constexpr char kIsKept[] = ". What is done is kept, and the same command goes on from there";

// In place of a data set that cannot be removed the next one goes.
void RemoveOne(const SpareData& spare) {
  const auto before = FreeDiskBytes(spare.place);
  try {
    spare.remove();
  } catch (const Error& error) {
    LogWarning(std::string(error.what()) + ": it is not removed for room");
    return;
  }
  const auto after = FreeDiskBytes(spare.place);
  const bool is_more = before && after && *after > *before;
  LogWarning(FileSystemOf(spare.place).mount_point.string() + ": room is short: removed " +
             spare.what + (is_more ? ", " + BytesText(*after - *before) : ""));
}

}  // namespace

DiskWatch::DiskWatch(WhenShort when_short, double seconds_between_looks) : when_short_(when_short) {
  try {
    thread_ = std::thread([=] { Watch(seconds_between_looks); });
  } catch (const std::system_error&) {
    LogWarning("The disk is looked at before each stage only: the system gives no thread for it");
  }
}

DiskWatch::~DiskWatch() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  ended_.notify_all();
  if (thread_.joinable()) thread_.join();
  SetWorkPaused(PauseReason::kDisk, false);
  StopWork("");
}

void DiskWatch::Begin(std::vector<DiskNeed> to_come, std::vector<SpareData> spare) {
  {
    const QuietThread loud(false);  // it may keep a watch waiting
    const std::lock_guard<std::mutex> lock(mutex_);
    to_come_ = std::move(to_come);
    spare_ = std::move(spare);
    Look();
  }
  WaitWhilePaused();
}

void DiskWatch::Watch(double seconds_between_looks) {
  const std::chrono::duration<double> pause(seconds_between_looks);
  std::unique_lock<std::mutex> lock(mutex_);
  while (!is_over_) {
    ended_.wait_for(lock, pause, [this] { return is_over_; });
    if (!is_over_) Look();
  }
}

// Callers hold mutex_, here and below.
void DiskWatch::Look() {
  const DiskFinding finding = AfterMakingRoom();
  const bool is_held = finding.verdict == DiskVerdict::kTooSmall && when_short_ != WhenShort::kWarn;
  if (is_held != is_held_) HoldWork(finding, is_held);
  if (finding.verdict == DiskVerdict::kEnough || is_held_ || has_warned_) return;
  has_warned_ = true;
  LogWarning(TextOf(finding) + kIsKept);
}

// One after the other goes, until there is enough.
DiskFinding DiskWatch::AfterMakingRoom() {
  DiskFinding finding = ShortestDisk(to_come_);
  while (finding.verdict != DiskVerdict::kEnough && !spare_.empty()) {
    const SpareData next = std::move(spare_.front());
    spare_.erase(spare_.begin());
    if (FileSystemOf(next.place).mount_point != finding.mount_point) continue;
    RemoveOne(next);
    finding = ShortestDisk(to_come_);
  }
  return finding;
}

void DiskWatch::HoldWork(const DiskFinding& finding, bool is_held) {
  // What was told to stop does not begin again.
  if (when_short_ == WhenShort::kStop && !is_held) return;
  is_held_ = is_held;
  if (when_short_ == WhenShort::kStop) {
    StopWork(TextOf(finding) + "; --check_disk 0 goes on all the same" + kIsKept);
    return;
  }
  if (is_held) {
    LogWarning(TextOf(finding) + ". Work pauses until there is room");
  } else {
    LogInfo("There is room on the disk again: work goes on");
  }
  SetWorkPaused(PauseReason::kDisk, is_held);
}

}  // namespace colmap_seapoint
