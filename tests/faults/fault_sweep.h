// The system fails at every call that a command makes, one run a call; what must hold of each run,
// and of the same command afterwards on a system that is well:
// - the exit code is 0, 1 or 3; with 1 the last line is an error of ours that is not "internal";
//   with 3 it is said what was left out;
// - with 0, and after the second run in any case, the files are those of a run without a fault;
// - no file under a final name is half of what it should be, and nothing stray is left.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace colmap_seapoint {

struct FaultSweepFigures {
  int num_calls = 0;  // at which faults could have been, over all kinds of faults
  int num_faults = 0, num_kills = 0;
  int num_done = 0, num_failed = 0, num_incomplete = 0;  // faults by exit code
  std::vector<std::string> complaints;                   // fault, call, finding and last line
};

// What is swept, by name of the command.
const std::vector<std::string>& SweptCommands();

// Every `stride`-th call, from the one on that `seed` chooses, of every kind of fault; of each kind
// one at least. Throws
// std::runtime_error when the command does not even run without a fault. A line for each kind goes
// to `log` (may be null). Cost: two runs of the command on three small pictures, a fault.
FaultSweepFigures SweepFaults(const std::string& command, int stride, unsigned seed,
                              std::ostream* log);

}  // namespace colmap_seapoint
