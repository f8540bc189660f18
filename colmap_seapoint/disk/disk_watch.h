// A disk that others fill too: watched while a job writes on it, so that the job ends, or waits,
// before the disk is full, and not in the middle of a file.
//
// When less is free than what is left of the job is expected to take, first goes what the job can
// do without, in a stated order (spare_data.h), one log line each. Where that is not enough, and
// less than the least is free that such jobs took, the job stops before its next step.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "colmap_seapoint/disk/disk_finding.h"

namespace colmap_seapoint {

// Data of ours that may be removed for room.
struct SpareData {
  std::string what;             // "the database of ...", as words for the user
  std::filesystem::path place;  // where room is made
  std::function<void()> remove;
};

enum class WhenShort {
  kStop,   // WorkStopped (base/hold/work_pause.h) in the work, which says what to do
  kPause,  // until there is room
  kWarn,
};

class DiskWatch {
 public:
  explicit DiskWatch(WhenShort when_short, double seconds_between_looks = 5);
  ~DiskWatch();
  DiskWatch(const DiskWatch&) = delete;
  DiskWatch& operator=(const DiskWatch&) = delete;

  // What is still to be written from now on, and what is not needed meanwhile: it may be removed at
  // any moment until the next call. Looks at once: throws WorkStopped, or returns after the pause.
  void Begin(std::vector<DiskNeed> to_come, std::vector<SpareData> spare);

 private:
  void Watch(double seconds_between_looks);
  void Look();
  DiskFinding AfterMakingRoom();
  void HoldWork(const DiskFinding& finding, bool is_held);

  const WhenShort when_short_;
  std::mutex mutex_;  // guards all below
  std::condition_variable ended_;
  std::vector<DiskNeed> to_come_;
  std::vector<SpareData> spare_;
  bool has_warned_ = false;
  bool is_held_ = false;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace colmap_seapoint
