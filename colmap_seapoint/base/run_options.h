// The options that every command has (seed, threads, memory, log level), and the way it ends.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

struct RunOptions {
  int random_seed = 0;     // of every random choice; 0 or more
  int num_threads = -1;    // -1 = all cores; never changes a result
  std::string max_memory;  // "4G", "500M" or bytes; empty = three quarters of the machine's
  int log_level = 2;       // 0 errors, 1 and warnings, 2 and progress, 3 and details

  void Bind(OptionTable* table);
};

struct CommandResult {
  bool is_complete = true;  // false: some input was left out, and named
  std::string text;         // what the user asked for, for stdout; may be empty
};

}  // namespace colmap_seapoint
