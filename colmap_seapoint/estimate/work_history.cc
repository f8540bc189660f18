#include "colmap_seapoint/estimate/work_history.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kRuns[] = "ratios_of_runs";
constexpr double kMaxRatio = 100;         // more is a machine that slept
constexpr size_t kMaxFileBytes = 100000;  // of a file of ours: kMaxRuns lines

// The runs in the file, the oldest first; none where it is no such file.
std::vector<RunRatios> ReadRuns(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error || size > kMaxFileBytes) return {};
  const auto file = OpenIfThere(path);
  const Json json = file != nullptr ? Json::parse(*file, nullptr, false) : Json();
  if (!json.is_object() || !json.contains(kRuns) || !json[kRuns].is_array()) return {};
  std::vector<RunRatios> runs;
  for (const Json& run : json[kRuns]) {
    if (!run.is_array() || run.size() != kNumWorks) continue;
    RunRatios ratios;
    for (size_t i = 0; i < run.size(); ++i) {
      const double ratio = run[i].is_number() ? run[i].get<double>() : 0;
      if (std::isfinite(ratio) && ratio > 0) ratios.values[i] = std::min(ratio, kMaxRatio);
    }
    runs.push_back(ratios);
  }
  return runs;
}

}  // namespace

std::optional<std::filesystem::path> HistoryPath() {
  const auto variable = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
  };
  std::filesystem::path cache = variable("XDG_CACHE_HOME");
  if (!cache.is_absolute()) {
    const std::filesystem::path home = variable("HOME");
    if (!home.is_absolute()) return std::nullopt;
    cache = home / ".cache";
  }
  return cache / "colmap_seapoint" / "history.json";
}

OfWork<double> ReadMachineRatios(const std::filesystem::path& history) {
  std::vector<RunRatios> runs;
  try {
    runs = ReadRuns(history);
  } catch (const std::exception&) {
    // A file that may not be read tells nothing.
  }
  OfWork<double> machine;
  for (size_t i = 0; i < kNumWorks; ++i) {
    std::vector<double> ratios = {1};
    for (const RunRatios& run : runs) {
      if (run.values[i] > 0) ratios.push_back(run.values[i]);
    }
    machine.values[i] = UpperMedian(std::move(ratios));
  }
  return machine;
}

void AddRun(const std::filesystem::path& history, const RunRatios& ratios) {
  try {
    std::vector<RunRatios> runs = ReadRuns(history);
    runs.push_back(ratios);
    if (runs.size() > kMaxRuns) runs.erase(runs.begin(), runs.end() - kMaxRuns);
    Json json;
    json["what"] =
        "seconds of work over those expected, run by run, for the time left; may be removed";
    json[kRuns] = Json::array();
    for (const RunRatios& run : runs) json[kRuns].push_back(run.values);
    std::filesystem::create_directories(history.parent_path());
    WriteTextFile(history, json.dump() + "\n");
  } catch (const std::exception&) {
    // A disk that is full or read-only: the next estimate is a little worse.
  }
}

}  // namespace colmap_seapoint
