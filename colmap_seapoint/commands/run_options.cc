#include "colmap_seapoint/commands/run_options.h"

#include <limits>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/fnv1a.h"

namespace colmap_seapoint {

void RunOptions::Bind(OptionTable* table) {
  table->Add("random_seed", &random_seed, "seed of every random choice", "COLMAP", 0,
             std::numeric_limits<int>::max());
  table->Add("num_threads", &num_threads, "threads, -1 = all cores; never changes a result",
             "COLMAP", -1, 1024);
  table->Add("log_level", &log_level,
             "what appears on stderr: 0 errors, 1 and warnings, 2 and progress, 3 and details",
             "COLMAP", 0, 3);
}

OptionList OptionValues(const OptionTable& table) {
  OptionList values;
  for (const OptionInfo& option : table.Options()) {
    values.emplace_back(option.name, OptionValueText(option.target));
  }
  return values;
}

std::string OptionsFingerprint(const OptionList& options) {
  std::string text;
  for (const auto& [name, value] : options) text += name + "=" + value + "\n";
  return HashBytes(text.data(), text.size());
}

void LeaveOut(const std::string& name, const std::string& reason, RunReport* report) {
  LogWarning(name + " is left out: " + reason);
  report->left_out.push_back({name, reason});
}

ExitCode ExitCodeOf(const RunReport& report) {
  return report.left_out.empty() ? kDone : kIncomplete;
}

}  // namespace colmap_seapoint
