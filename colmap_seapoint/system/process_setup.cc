#include "colmap_seapoint/system/process_setup.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <limits>
#include <opencv2/core/utility.hpp>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr int kEndingSignals[] = {SIGINT, SIGTERM, SIGHUP};

// /dev/null the wrong way round: reading from a closed stdin and writing to a closed stdout fail as
// they did before.
void OccupyStandardDescriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest free number is this one: those below it are occupied by now.
    const int opened = open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (opened != descriptor) std::abort();  // not even /dev/null: nothing can be said either
  }
}

// Only what is allowed in a signal handler.
extern "C" void SayAndEnd(int number) {
  static constexpr char kLine[] = "error: interrupted; run the same command again to continue\n";
  static constexpr char kWipe[] = "\r\033[K";  // a progress line, or the ^C of the terminal
  if (isatty(STDERR_FILENO) == 1) {
    if (write(STDERR_FILENO, kWipe, sizeof(kWipe) - 1) < 0) errno = 0;
  }
  if (write(STDERR_FILENO, kLine, sizeof(kLine) - 1) < 0) errno = 0;
  // SA_RESETHAND: the default action, which comes when the handler returns.
  raise(number);
}

void SetUpSignals() {
  for (const int number : {SIGXFSZ, SIGPIPE}) signal(number, SIG_IGN);
  for (const int number : kEndingSignals) {
    struct sigaction action {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler != SIG_DFL) continue;
    action.sa_handler = SayAndEnd;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigfillset(&action.sa_mask);
    sigaction(number, &action, nullptr);
  }
}

// Buffers of megabytes come and go. By default each would be fresh memory, zeroed by the system
// page by page and given back: what is freed is kept for the next one. Not so the largest, planes
// of pictures and clouds: what little stays between them would leave holes that the next one does
// not fit into, and memory would grow with the number of pictures.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kNotKept = 10'000'000;  // bytes
  mallopt(M_MMAP_THRESHOLD, kNotKept);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_ARENA_MAX, 1);
#endif
}

}  // namespace

void SetUpProcess() {
  OccupyStandardDescriptors();
  SetUpSignals();
  KeepFreedMemory();
  // OpenCV's threads are oneTBB's, which fails where they cannot be started. The work is on
  // threads of ours by then. Not 1, with which oneTBB would be set up all the same.
  cv::setNumThreads(0);
}

void FinishOutput() {
  // Where a writing has failed before this, errno is still its own: nothing is opened in between.
  if (std::cout.good()) errno = 0;
  std::cout.flush();
  // Some file systems tell only when the file is closed that it did not fit.
  const bool is_flushed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  const int flush_error = errno;
  const int copy = is_flushed ? dup(STDOUT_FILENO) : -1;
  if (is_flushed && (copy < 0 || close(copy) == 0)) return;
  const int error_number = is_flushed ? errno : flush_error;
  throw Error("stdout",
              "the result could not be written (" +
                  SystemText(error_number != 0 ? error_number : EIO) + ")",
              "send it to a file that can be written, or to a program that reads all of it");
}

}  // namespace colmap_seapoint
