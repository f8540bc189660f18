#include "colmap_seapoint/base/run_options.h"

#include <limits>

namespace colmap_seapoint {

void RunOptions::Bind(OptionTable* table) {
  table->Add("random_seed", &random_seed, "seed of every random choice", "COLMAP", 0,
             std::numeric_limits<int>::max());
  table->Add("num_threads", &num_threads, "threads, -1 = all cores; never changes a result",
             "COLMAP", -1, 1024);
  table->Add("max_memory", &max_memory,
             "what the pictures of all threads may take together, e.g. 4G, 500M, or bytes; a "
             "picture that needs more alone is left out; empty = three quarters of what the "
             "machine or its container has",
             "ours");
  table->Add("log_level", &log_level,
             "what appears on stderr: 0 errors, 1 and warnings, 2 and progress, 3 and details",
             "COLMAP", 0, 3);
}

}  // namespace colmap_seapoint
