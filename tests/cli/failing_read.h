// A disk that cannot give a file's bytes, for programs of ours that run as children: their system
// calls are answered by the test (seccomp's user notification), so that stdio, SQLite and every
// library meet the failure where it happens.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <string>
#include <thread>

namespace colmap_seapoint {

struct FailingRead {
  std::string path_end;        // of the file, as "/list.txt"
  int64_t from_offset = 0;     // reads that begin here or behind fail with EIO,
  int max_failures = 1 << 30;  // as often; then they succeed,
  int num_reads_before = 0;    // after so many of them that succeed
};

// One for each child.
class ReadFailer {
 public:
  explicit ReadFailer(const FailingRead& failure);
  ~ReadFailer();  // after the child has ended
  ReadFailer(const ReadFailer&) = delete;
  ReadFailer& operator=(const ReadFailer&) = delete;

  void StartInChild();      // in the child, before exec()
  void Watch(pid_t child);  // in the parent, after fork()
  int NumFailed() const { return num_failed_; }

 private:
  void Answer(int listener);
  bool MustFail(pid_t process, int number, const unsigned long long* arguments);

  const FailingRead failure_;
  int pipe_[2];
  std::thread thread_;
  int num_met_ = 0;
  std::atomic<int> num_failed_{0};
};

}  // namespace colmap_seapoint
