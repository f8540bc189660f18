// A thread whose work is told in one line by who asked for it, and not by the work itself.
#pragma once

namespace colmap_seapoint {

// While it lives, nothing but errors is logged (base/progress.h) from the thread that made it.
class QuietThread {
 public:
  explicit QuietThread(bool is_quiet);
  ~QuietThread();
  QuietThread(const QuietThread&) = delete;
  QuietThread& operator=(const QuietThread&) = delete;

 private:
  const bool before_;
};

bool ThisThreadIsQuiet();
bool SomeThreadIsQuiet();

}  // namespace colmap_seapoint
