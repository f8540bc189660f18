#include "colmap_seapoint/base/hold/quiet_thread.h"

#include <atomic>

namespace colmap_seapoint {
namespace {

thread_local bool is_quiet_now = false;
std::atomic<int> num_quiet{0};

}  // namespace

QuietThread::QuietThread(bool is_quiet) : before_(is_quiet_now) {
  is_quiet_now = is_quiet;
  num_quiet += int{is_quiet} - int{before_};
}

QuietThread::~QuietThread() {
  num_quiet += int{before_} - int{is_quiet_now};
  is_quiet_now = before_;
}

bool ThisThreadIsQuiet() { return is_quiet_now; }

bool SomeThreadIsQuiet() { return num_quiet > 0; }

}  // namespace colmap_seapoint
