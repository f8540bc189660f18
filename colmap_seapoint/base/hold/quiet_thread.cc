#include "colmap_seapoint/base/hold/quiet_thread.h"

namespace colmap_seapoint {
namespace {

thread_local bool is_quiet_now = false;

}  // namespace

QuietThread::QuietThread(bool is_quiet) : before_(is_quiet_now) { is_quiet_now = is_quiet; }

QuietThread::~QuietThread() { is_quiet_now = before_; }

bool ThisThreadIsQuiet() { return is_quiet_now; }

}  // namespace colmap_seapoint
