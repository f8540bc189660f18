// run.json: what a run did, with what, how long it took and what it left out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/base/timer.h"
#include "colmap_seapoint/base/version.h"

namespace colmap_seapoint {

struct RunReport {
  struct LeftOut {
    std::string name;    // as the user knows it: a picture's name, or a model's folder
    std::string reason;  // one line
  };
  struct Stage {
    std::string name;
    double wall_seconds = 0;
    double cpu_seconds = 0;  // user + sys, children that ended included
  };
  struct Input {
    std::string name;
    uint64_t size = 0;  // bytes
    std::string hash;   // HashFile(); empty when the file could not be read
  };

  std::string version;
  std::string command;
  std::vector<std::pair<std::string, std::string>> options;  // name and value, as typed
  int seed = 0;
  int num_threads = 1;
  int64_t images_in = 0;
  int64_t images_used = 0;
  std::vector<LeftOut> left_out;
  std::vector<std::string> cameras;  // a line each: its pictures, and where its lens is from
  int64_t pairs = 0;
  int64_t points = 0;
  std::string units;  // of what was written: "arbitrary" or "metres"; empty where there are none
  std::vector<Stage> stages;
  std::vector<Input> inputs;
};

// Hash of names and values: changes when any option does.
std::string OptionsFingerprint(const OptionList& options);

// Report with version, command, options, seed and threads filled in.
template <typename Options>
RunReport StartReport(const std::string& command, const Options& options, const RunOptions& run) {
  RunReport report;
  report.version = Version();
  report.command = command;
  report.options = OptionValues(options);
  report.seed = run.random_seed;
  report.num_threads = EffectiveNumThreads(run.num_threads);
  return report;
}

// Notes an input that is not used, on stderr and in the report.
void LeaveOut(const std::string& name, const std::string& reason, RunReport* report);

// Appends the stages of a part of a run, and what it left out: each name once, since a picture can
// be left out of several models. The cameras are those of the last part that has any.
void AddPart(const RunReport& part, RunReport* report);

// Incomplete when something was left out.
CommandResult ResultOf(const RunReport& report);

// Adds a stage that lasts from construction to destruction.
class StageTimer {
 public:
  StageTimer(RunReport* report, const std::string& name);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  RunReport* report_;
  std::string name_;
  Timer timer_;
  double children_cpu_start_ = 0;
};

// Highest resident memory of this process so far, and of its largest ended child, in bytes.
uint64_t PeakRssBytes();

// Size and content hash of a file; a file that cannot be read gives size 0 and an empty hash.
RunReport::Input DescribeInput(const std::string& name, const std::filesystem::path& path);

// Atomic. Throws Error when the file cannot be written. peak_rss_bytes is taken now. Bytes that are
// no UTF-8 (file names can hold any) become U+FFFD.
void WriteRunReport(const std::filesystem::path& path, const RunReport& report);

}  // namespace colmap_seapoint
