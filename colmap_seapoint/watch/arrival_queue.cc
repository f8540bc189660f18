#include "colmap_seapoint/watch/arrival_queue.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <iterator>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/picture.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/image/jpeg_exif.h"
#include "colmap_seapoint/system/failure_line.h"
#include "colmap_seapoint/watch/small_copy.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kBetweenLooks{500};

// "dive/a.jpg", and "dive/a.png.jpg" of a picture that is none.
std::string CopyName(const std::string& name) {
  std::string extension = fs::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension == ".jpg" || extension == ".jpeg" ? name : name + ".jpg";
}

}  // namespace

ArrivalQueue::ArrivalQueue(fs::path folder, fs::path copies)
    : folder_(std::move(folder)), copies_(std::move(copies)), thread_([this] { Watch(); }) {}

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

std::vector<NewPicture> ArrivalQueue::LookOnce(PictureArrivals* arrivals,
                                               OverlapWatch* overlaps) const {
  std::vector<NewPicture> found;
  arrivals->Look(Now(), [&](const Arrival& arrival, const ColorImage& picture) {
    const ColorImage small = SmallCopy(picture);
    NewPicture one = {arrival, CopyName(arrival.name), overlaps->Add(arrival.name, LumaOf(small))};
    if (!one.overlap.warning.empty()) LogWarning(one.overlap.warning);
    const fs::path copy = copies_ / one.copy_name;
    std::error_code error;  // whose result WriteJpeg says
    fs::create_directories(copy.parent_path(), error);
    WriteJpeg(copy, small, CleanExifOf(folder_ / arrival.name));
    found.push_back(std::move(one));
  });
  return found;
}

void ArrivalQueue::Publish(std::vector<NewPicture> found) {
  if (found.empty()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  std::move(found.begin(), found.end(), std::back_inserter(new_));
  last_arrival_ = Now();
  changed_.notify_all();
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
      Publish(LookOnce(&arrivals, &overlaps));
      if (is_gone) LogInfo(folder_.string() + " is there again");
      is_gone = false;
    } catch (const std::exception& error) {
      if (!is_gone) LogWarning(FailureLine(error) + "; tried again until it is mended");
      is_gone = true;
    }
    lock.lock();
    if (is_gone) last_arrival_ = Now();  // it cannot be idle
    changed_.wait_for(lock, kBetweenLooks, [this] { return is_over_; });
  }
}

}  // namespace colmap_seapoint
