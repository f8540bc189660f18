// The pictures that have come into a folder and wait for their round, watched by a thread of its
// own: while a round is at work, whoever steers is told within a second that the overlap drops.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "colmap_seapoint/watch/overlap_watch.h"
#include "colmap_seapoint/watch/picture_arrivals.h"

namespace colmap_seapoint {

struct NewPicture {
  Arrival arrival;
  std::string copy_name;  // of its small copy
  NewOverlap overlap;
};

class ArrivalQueue {
 public:
  // Small copies of what comes into `folder`, JPEGs with its EXIF, are put into `copies`, which is
  // made when missing.
  ArrivalQueue(std::filesystem::path folder, std::filesystem::path copies);
  ~ArrivalQueue();
  ArrivalQueue(const ArrivalQueue&) = delete;
  ArrivalQueue& operator=(const ArrivalQueue&) = delete;

  // All that came since the last call, in the order in which it came, what came together at once;
  // waits for it for a moment.
  std::vector<NewPicture> Take();
  double Now() const;  // seconds since the watch began
  // When something came last, or could have come but for a folder that was gone; 0: never.
  double LastArrival() const;

 private:
  void Watch();
  std::vector<NewPicture> LookOnce(PictureArrivals* arrivals, OverlapWatch* overlaps) const;
  void Publish(std::vector<NewPicture> found);

  const std::filesystem::path folder_, copies_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::vector<NewPicture> new_;
  double last_arrival_ = 0;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace colmap_seapoint
