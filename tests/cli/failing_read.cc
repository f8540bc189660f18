#include "tests/cli/failing_read.h"

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace colmap_seapoint {
namespace {

constexpr int kListener = 200;  // its descriptor in the child

std::string PathOf(pid_t process, int descriptor) {
  std::error_code error;
  return std::filesystem::read_symlink(
             "/proc/" + std::to_string(process) + "/fd/" + std::to_string(descriptor), error)
      .string();
}

int64_t OffsetOf(pid_t process, int descriptor) {
  std::ifstream info("/proc/" + std::to_string(process) + "/fdinfo/" + std::to_string(descriptor));
  std::string key;
  int64_t offset = 0;
  return info >> key >> offset ? offset : 0;
}

}  // namespace

ReadFailer::ReadFailer(const FailingRead& failure) : failure_(failure) {
  if (pipe(pipe_) != 0) throw std::runtime_error("no pipe");
}

ReadFailer::~ReadFailer() {
  if (thread_.joinable()) thread_.join();
  for (const int end : pipe_) close(end);
}

void ReadFailer::StartInChild() {
  sock_filter filter[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_read, 1, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_pread64, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program = {static_cast<unsigned short>(std::size(filter)), filter};
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  const long listener =
      syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program);
  const char is_there = listener >= 0 && dup2(static_cast<int>(listener), kListener) >= 0;
  if (write(pipe_[1], &is_there, 1) != 1) _exit(124);
  close(static_cast<int>(listener));
}

void ReadFailer::Watch(pid_t child) {
  char is_there = 0;
  if (read(pipe_[0], &is_there, 1) != 1 || is_there == 0) {
    throw std::runtime_error("this system's seccomp cannot notify");
  }
  const int process = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
  const int listener = static_cast<int>(syscall(SYS_pidfd_getfd, process, kListener, 0));
  close(process);
  if (listener < 0) throw std::runtime_error("the child's descriptor cannot be had");
  thread_ = std::thread([this, listener] { Answer(listener); });
}

bool ReadFailer::MustFail(pid_t process, int number, const unsigned long long* arguments) {
  const int descriptor = static_cast<int>(arguments[0]);
  const std::string path = PathOf(process, descriptor);
  const std::string& end = failure_.path_end;
  if (path.size() < end.size() || path.compare(path.size() - end.size(), end.size(), end) != 0) {
    return false;
  }
  const int64_t offset =
      number == SYS_pread64 ? static_cast<int64_t>(arguments[3]) : OffsetOf(process, descriptor);
  if (offset < failure_.from_offset || num_met_++ < failure_.num_reads_before) return false;
  return num_failed_ < failure_.max_failures;
}

// Until no process is left that could call.
void ReadFailer::Answer(int listener) {
  pollfd poll_listener = {listener, POLLIN, 0};
  while (poll(&poll_listener, 1, -1) > 0 && (poll_listener.revents & POLLIN) != 0) {
    seccomp_notif call{};
    if (ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &call) != 0) continue;
    seccomp_notif_resp answer{};
    answer.id = call.id;
    if (MustFail(static_cast<pid_t>(call.pid), call.data.nr, call.data.args)) {
      answer.error = -EIO;
      ++num_failed_;
    } else {
      answer.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE;
    }
    ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &answer);
  }
  close(listener);
}

}  // namespace colmap_seapoint
