// Three kinds of errors; main.cc is the only place that catches all of them.
//   Error           a fault of the input or of the machine: where, what was found, what to do. The
//                   program ends with exit code 1.
//   UsageError      a fault of the command line; exit code 2.
//   SEAPOINT_CHECK  a bug of ours: throws std::logic_error that names the condition and its place
//                   in the code; exit code 1.
// Ordinary outcomes (no overlap, too few seeds) are no errors: they are a status in the result.
#pragma once

#include <stdexcept>
#include <string>

namespace colmap_seapoint {

// what() reads "<where>: <finding>; <remedy>", one line.
class Error : public std::runtime_error {
 public:
  Error(const std::string& where, const std::string& finding, const std::string& remedy)
      : std::runtime_error(where + ": " + finding + "; " + remedy), finding_(finding) {}

  // The middle part alone, for `left_out` lists where the name stands beside it.
  const std::string& Finding() const { return finding_; }

 private:
  std::string finding_;
};

class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

#define SEAPOINT_CHECK(condition)                                                                \
  ((condition) ? static_cast<void>(0)                                                            \
               : throw std::logic_error(std::string("internal check failed: " #condition " (") + \
                                        __FILE__ + ":" + std::to_string(__LINE__) + ")"))

}  // namespace colmap_seapoint
