// What every command has: seed, threads, log level, and the head of its run report.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/commands/command.h"
#include "colmap_seapoint/io/run_report.h"

namespace colmap_seapoint {

struct RunOptions {
  int random_seed = 0;
  int num_threads = -1;
  int log_level = 2;

  void Bind(OptionTable* table);
};

using OptionList = std::vector<std::pair<std::string, std::string>>;

OptionList OptionValues(const OptionTable& table);

// Name and value of everything that `options` binds. By value: Bind() wants an object to change.
template <typename Options>
OptionList OptionValues(Options options) {
  OptionTable table;
  options.Bind(&table);
  return OptionValues(table);
}

// Hash of names and values: changes when any option does.
std::string OptionsFingerprint(const OptionList& options);

// Report with version, command, options, seed and threads filled in.
template <typename Options>
RunReport StartReport(const std::string& command, const Options& options, const RunOptions& run) {
  RunReport report;
  report.version = SEAPOINT_VERSION;
  report.command = command;
  report.options = OptionValues(options);
  report.seed = run.random_seed;
  report.num_threads = EffectiveNumThreads(run.num_threads);
  return report;
}

// Notes an input that is not used, on stderr and in the report.
void LeaveOut(const std::string& name, const std::string& reason, RunReport* report);

// kIncomplete when something was left out.
ExitCode ExitCodeOf(const RunReport& report);

}  // namespace colmap_seapoint
