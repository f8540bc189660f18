// The wish of a user to bring a long watch to its end: the first Ctrl-C.
#pragma once

#include <signal.h>

namespace colmap_seapoint {

// While it lives, the first SIGINT says "that is all" and interrupts nothing; the second one ends
// the process as it does everywhere else. One that was ignored by who started us stays so. One at a
// time.
class FinishRequest {
 public:
  FinishRequest();
  ~FinishRequest();
  FinishRequest(const FinishRequest&) = delete;
  FinishRequest& operator=(const FinishRequest&) = delete;

  bool IsMade() const;

 private:
  struct sigaction before_ {};
};

}  // namespace colmap_seapoint
