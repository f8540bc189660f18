#include "tests/faults/fault_injector.h"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace colmap_seapoint {
namespace {

constexpr int kListener = 200;  // its descriptor in the child
constexpr int kNone = -1;

// Where the arguments of a system call name its file: a descriptor, or a path that may be relative
// to a descriptor's folder.
struct CallForm {
  int number;
  SystemCall call;
  int descriptor_argument, path_argument;
};

constexpr CallForm kForms[] = {
    {SYS_read, SystemCall::kRead, 0, kNone},        {SYS_readv, SystemCall::kRead, 0, kNone},
    {SYS_pread64, SystemCall::kRead, 0, kNone},     {SYS_getdents64, SystemCall::kRead, 0, kNone},
    {SYS_write, SystemCall::kWrite, 0, kNone},      {SYS_writev, SystemCall::kWrite, 0, kNone},
    {SYS_pwrite64, SystemCall::kWrite, 0, kNone},   {SYS_ftruncate, SystemCall::kResize, 0, kNone},
    {SYS_fallocate, SystemCall::kResize, 0, kNone}, {SYS_fsync, SystemCall::kSync, 0, kNone},
    {SYS_fdatasync, SystemCall::kSync, 0, kNone},   {SYS_openat, SystemCall::kOpenToRead, 0, 1},
    {SYS_renameat, SystemCall::kRename, 2, 3},      {SYS_renameat2, SystemCall::kRename, 2, 3},
    {SYS_unlinkat, SystemCall::kRemove, 0, 1},      {SYS_mkdirat, SystemCall::kMakeFolder, 0, 1},
    {SYS_mmap, SystemCall::kMap, 4, kNone},         {SYS_clone, SystemCall::kStart, kNone, kNone},
    {SYS_clone3, SystemCall::kStart, kNone, kNone},
#ifdef SYS_open  // newer machines have only those that take a folder
    {SYS_open, SystemCall::kOpenToRead, kNone, 0},  {SYS_rename, SystemCall::kRename, kNone, 1},
    {SYS_unlink, SystemCall::kRemove, kNone, 0},    {SYS_rmdir, SystemCall::kRemove, kNone, 0},
    {SYS_mkdir, SystemCall::kMakeFolder, kNone, 0}, {SYS_fork, SystemCall::kStart, kNone, kNone},
    {SYS_vfork, SystemCall::kStart, kNone, kNone},
#endif
};

// Only what may matter is stopped at, since each stop costs as much as many calls.
bool MayMatter(const Fault& fault, SystemCall call) {
  const auto is_asked_for = [&](SystemCall asked) { return fault.calls.count(asked) > 0; };
  if (call != SystemCall::kOpenToRead) return is_asked_for(call);
  const bool needs_paths = is_asked_for(SystemCall::kMap) || is_asked_for(SystemCall::kStart);
  return is_asked_for(call) || is_asked_for(SystemCall::kOpenToWrite) || needs_paths;
}

const char* NameOf(SystemCall call) {
  constexpr const char* kNames[] = {"open to read", "open to write", "read",   "write",
                                    "resize",       "sync",          "rename", "remove",
                                    "make folder",  "map",           "start"};
  return kNames[static_cast<size_t>(call)];
}

std::string LinkTarget(pid_t process, const std::string& link) {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/" + std::to_string(process) + "/" + link, error)
      .string();
}

std::string PathOf(pid_t process, int descriptor) {
  return LinkTarget(process, descriptor == AT_FDCWD ? "cwd" : "fd/" + std::to_string(descriptor));
}

int64_t OffsetOf(pid_t process, int descriptor) {
  std::ifstream info("/proc/" + std::to_string(process) + "/fdinfo/" + std::to_string(descriptor));
  std::string key;
  int64_t offset = 0;
  return info >> key >> offset ? offset : 0;
}

// Page by page, since the text may end where the memory does.
std::string TextAt(pid_t process, uint64_t address) {
  constexpr uint64_t kPage = 4096;
  std::string text;
  while (text.size() < PATH_MAX) {
    char page[kPage];
    const iovec from = {reinterpret_cast<void*>(address), kPage - address % kPage};
    const iovec to = {page, from.iov_len};
    const ssize_t size = process_vm_readv(process, &to, 1, &from, 1, 0);
    if (size <= 0) return text;
    char* end = std::find(page, page + size, '\0');
    text.append(page, static_cast<size_t>(end - page));
    if (end != page + size) return text;
    address += static_cast<uint64_t>(size);
  }
  return text;
}

bool IsOpenedToWrite(uint64_t flags) { return (flags & (O_CREAT | O_WRONLY | O_RDWR)) != 0; }

pid_t ProcessOfThread(pid_t thread) {
  std::ifstream status("/proc/" + std::to_string(thread) + "/status");
  for (std::string word; status >> word;) {
    if (word == "Tgid:" && status >> thread) break;
  }
  return thread;
}

// Does the first half of a read or write in the child's place; -1 with errno where that fails.
int64_t DoHalf(pid_t process, int number, const std::array<uint64_t, 6>& arguments) {
  const int handle = static_cast<int>(syscall(SYS_pidfd_open, ProcessOfThread(process), 0));
  const int file =
      static_cast<int>(syscall(SYS_pidfd_getfd, handle, static_cast<int>(arguments[0]), 0));
  close(handle);
  if (file < 0) return -1;
  std::vector<char> bytes(arguments[2] / 2);
  const iovec here = {bytes.data(), bytes.size()};
  const iovec there = {reinterpret_cast<void*>(arguments[1]), bytes.size()};
  const auto offset = static_cast<off_t>(arguments[3]);
  int64_t size = -1;
  if (number == SYS_read || number == SYS_pread64) {
    size = number == SYS_read ? read(file, bytes.data(), bytes.size())
                              : pread(file, bytes.data(), bytes.size(), offset);
    if (size > 0) process_vm_writev(process, &here, 1, &there, 1, 0);
  } else if (process_vm_readv(process, &here, 1, &there, 1, 0) ==
             static_cast<ssize_t>(bytes.size())) {
    size = number == SYS_write ? write(file, bytes.data(), bytes.size())
                               : pwrite(file, bytes.data(), bytes.size(), offset);
  }
  const int error_number = errno;
  close(file);
  errno = error_number;
  return size;
}

}  // namespace

struct FaultInjector::Call {
  explicit Call(const seccomp_notif& notice)
      : process(static_cast<pid_t>(notice.pid)), number(notice.data.nr) {
    std::copy_n(notice.data.args, arguments.size(), arguments.begin());
    const CallForm& form = *std::find_if(std::begin(kForms), std::end(kForms),
                                         [&](const CallForm& f) { return f.number == number; });
    call = form.call;
    if (form.descriptor_argument != kNone) {
      descriptor = static_cast<int>(arguments[static_cast<size_t>(form.descriptor_argument)]);
    }
    if (form.path_argument != kNone) {
      const auto place = static_cast<size_t>(form.path_argument);
      if (call == SystemCall::kOpenToRead && IsOpenedToWrite(arguments[place + 1])) {
        call = SystemCall::kOpenToWrite;
      }
      path = TextAt(process, arguments[place]);
      if (!path.empty() && path[0] != '/') path = PathOf(process, descriptor) + "/" + path;
    } else if (descriptor >= 0) {
      path = PathOf(process, descriptor);
    }
  }

  bool HasNoFile() const { return path.empty(); }
  bool CanBeShortened() const {
    return (number == SYS_read || number == SYS_pread64 || number == SYS_write ||
            number == SYS_pwrite64) &&
           arguments[2] > 1;
  }
  int64_t Offset() const {
    if (call != SystemCall::kRead) return 0;
    return number == SYS_pread64 ? static_cast<int64_t>(arguments[3])
                                 : OffsetOf(process, descriptor);
  }

  pid_t process;  // or thread of it
  int number;
  std::array<uint64_t, 6> arguments{};
  SystemCall call = SystemCall::kRead;
  int descriptor = AT_FDCWD;
  std::string path;
};

FaultInjector::~FaultInjector() {
  if (thread_.joinable()) thread_.join();
}

void FaultInjector::StartInChild() {
  std::vector<sock_filter> filter = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
  for (const CallForm& form : kForms) {
    if (!MayMatter(fault_, form.call)) continue;
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<uint32_t>(form.number), 0, 1));
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF));
  }
  filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  const sock_fprog program = {static_cast<unsigned short>(filter.size()), filter.data()};
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  const long listener =
      syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program);
  if (listener < 0 || dup2(static_cast<int>(listener), kListener) < 0) _exit(124);
  close(static_cast<int>(listener));
}

void FaultInjector::Watch(pid_t child) {
  child_ = child;
  const int process = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
  // The descriptor appears as soon as the child has come so far.
  int listener = -1;
  for (int i = 0; listener < 0 && i < 5000; ++i) {
    listener = static_cast<int>(syscall(SYS_pidfd_getfd, process, kListener, 0));
    if (listener < 0) usleep(1000);
  }
  close(process);
  if (listener < 0) throw std::runtime_error("this system's seccomp cannot notify");
  thread_ = std::thread([this, listener] { Answer(listener); });
}

FaultCounts FaultInjector::Finish() {
  if (thread_.joinable()) thread_.join();
  return counts_;
}

bool FaultInjector::MustHit(const Call& call) {
  const std::string& begin = fault_.path_begin;
  const std::string& end = fault_.path_end;
  const bool fits_path = call.path.size() >= std::max(begin.size(), end.size()) &&
                         call.path.compare(0, begin.size(), begin) == 0 &&
                         call.path.compare(call.path.size() - end.size(), end.size(), end) == 0;
  has_met_path_ = has_met_path_ || (fits_path && !call.HasNoFile());
  if (fault_.calls.count(call.call) == 0) return false;
  if (call.HasNoFile() ? !has_met_path_ : !fits_path) return false;
  if (fault_.from_offset > 0 && call.Offset() < fault_.from_offset) return false;
  if (fault_.action == FaultAction::kShorten && !call.CanBeShortened()) return false;
  if (counts_.num_calls++ < fault_.num_calls_before) return false;
  if (counts_.num_hits >= fault_.max_hits) return false;
  if (counts_.num_hits++ == 0) counts_.first_hit = NameOf(call.call) + (" " + call.path);
  return true;
}

// Until no process is left that could call.
void FaultInjector::Answer(int listener) {
  pollfd poll_listener = {listener, POLLIN, 0};
  while (poll(&poll_listener, 1, -1) > 0 && (poll_listener.revents & POLLIN) != 0) {
    seccomp_notif notice{};
    if (ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &notice) != 0) continue;
    seccomp_notif_resp answer{};
    answer.id = notice.id;
    const Call call(notice);
    if (!MustHit(call)) {
      answer.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE;
    } else if (fault_.action == FaultAction::kKill) {
      kill(child_, SIGKILL);
      answer.error = -EINTR;  // reaches those only that the program had started
    } else if (fault_.action == FaultAction::kShorten) {
      answer.val = DoHalf(call.process, call.number, call.arguments);
      if (answer.val < 0) answer.error = -errno;
    } else {
      answer.error = -fault_.error_number;
    }
    ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &answer);
  }
  close(listener);
}

bool CanInjectFaults() {
  static const bool can = [] {
    FaultInjector injector({});
    const pid_t child = fork();
    if (child < 0) return false;
    if (child == 0) {
      injector.StartInChild();
      pause();
      _exit(0);
    }
    bool watches = true;
    try {
      injector.Watch(child);
    } catch (const std::runtime_error&) {
      watches = false;
    }
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    injector.Finish();
    return watches;
  }();
  return can;
}

}  // namespace colmap_seapoint
