#include "colmap_seapoint/watch/arrival_queue.h"

#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{500};

}  // namespace

ArrivalQueue::ArrivalQueue(const std::filesystem::path& folder)
    : folder_(folder), thread_([this] { Watch(); }) {}

ArrivalQueue::~ArrivalQueue() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::vector<NewPicture> ArrivalQueue::Take() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, kBetweenLooks, [this] { return !new_.empty(); });
  return std::exchange(new_, {});
}

double ArrivalQueue::Now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double ArrivalQueue::LastArrival() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_arrival_;
}

void ArrivalQueue::LookOnce(PictureArrivals* arrivals, OverlapWatch* overlaps) {
  arrivals->Look(Now(), [&](const Arrival& arrival, const GrayImage& picture) {
    NewPicture found;
    found.arrival = arrival;
    found.overlap.is_first = true;
    if (!picture.Empty()) found.overlap = overlaps->Add(arrival.name, picture);
    if (!found.overlap.warning.empty()) LogWarning(found.overlap.warning);
    const std::lock_guard<std::mutex> lock(mutex_);
    new_.push_back(std::move(found));
    last_arrival_ = Now();
    changed_.notify_all();
  });
}

// A folder that is gone may come back: a disk that was pulled is put back.
void ArrivalQueue::Watch() {
  PictureArrivals arrivals(folder_);
  OverlapWatch overlaps;
  bool is_gone = false;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!is_over_) {
    lock.unlock();
    try {
      LookOnce(&arrivals, &overlaps);
      if (is_gone) LogInfo(folder_.string() + " is there again");
      is_gone = false;
    } catch (const Error& error) {
      if (!is_gone) LogWarning(std::string(error.what()) + "; waiting for it to be there again");
      is_gone = true;
    }
    lock.lock();
    if (is_gone) last_arrival_ = Now();  // it cannot be idle
    changed_.wait_for(lock, kBetweenLooks, [this] { return is_over_; });
  }
}

}  // namespace colmap_seapoint
