#include "colmap_seapoint/system/finish_request.h"

namespace colmap_seapoint {
namespace {

volatile sig_atomic_t is_made = 0;
struct sigaction as_everywhere {};

// Only what is allowed in a signal handler.
extern "C" void NoteWish(int number) {
  is_made = 1;
  sigaction(number, &as_everywhere, nullptr);
}

}  // namespace

FinishRequest::FinishRequest() {
  is_made = 0;
  sigaction(SIGINT, nullptr, &before_);
  if (before_.sa_handler == SIG_IGN) return;
  as_everywhere = before_;
  struct sigaction action {};
  action.sa_handler = NoteWish;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
}

FinishRequest::~FinishRequest() { sigaction(SIGINT, &before_, nullptr); }

bool FinishRequest::IsMade() const { return is_made != 0; }

}  // namespace colmap_seapoint
