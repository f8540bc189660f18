#include "colmap_seapoint/pipeline/compare.h"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/same_file.h"
#include "colmap_seapoint/report/comparison_report.h"
#include "colmap_seapoint/report/difference_files.h"
#include "colmap_seapoint/workspace/earlier_outputs.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

// "0.01,0.02": positive, ascending.
std::vector<double> ParseDistances(const std::string& text) {
  std::vector<double> distances;
  if (text.empty()) return distances;
  std::istringstream words(text + ",");
  for (std::string word; std::getline(words, word, ',');) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    const bool is_number = !word.empty() && *end == '\0' && std::isfinite(value) && value > 0;
    if (!is_number || (!distances.empty() && value <= distances.back())) {
      throw UsageError("--distances " + text +
                       ": must be positive numbers, each larger than the "
                       "one before, with commas between them");
    }
    distances.push_back(value);
  }
  if (distances.size() > kMaxDistances) {
    throw UsageError("--distances " + text + ": must be " + std::to_string(kMaxDistances) +
                     " or fewer");
  }
  return distances;
}

CompareOptions ToCompareOptions(const CloudComparerOptions& options) {
  CompareOptions compare = options.compare;
  compare.distances = ParseDistances(options.distances);
  compare.num_threads = options.run.num_threads;
  if (compare.max_distance > 0 && !compare.distances.empty() &&
      compare.max_distance < compare.distances.back()) {
    throw UsageError("--max_distance must not be below the largest of --distances");
  }
  return compare;
}

// nullptr when no difference files are asked for.
std::unique_ptr<OutputFolder> ClaimDifferences(const CloudComparerOptions& options) {
  if (options.difference_path.empty()) return nullptr;
  for (const std::string& name : DifferenceNames()) {
    const auto path = std::filesystem::path(options.difference_path) / name;
    for (const std::string& input : {options.input_path, options.reference_path}) {
      if (!IsSameFile(path, input)) continue;
      throw UsageError("difference_path would replace the cloud " + input +
                       ", which is to be compared; name another folder");
    }
  }
  auto folder = std::make_unique<OutputFolder>(options.difference_path, "--difference_path");
  AdoptEarlierOutputs(folder.get());
  folder->Claim(DifferenceNames());
  return folder;
}

// Shows one progress line for each stage of the comparison.
class StageProgress {
 public:
  void Update(const std::string& stage, int64_t done, int64_t total) {
    if (stage != stage_) {
      if (progress_) progress_->Finish();
      progress_ = std::make_unique<Progress>(stage, total);
      stage_ = stage;
    }
    progress_->Update(done);
  }
  void Finish() {
    if (progress_) progress_->Finish();
  }

 private:
  std::string stage_;
  std::unique_ptr<Progress> progress_;
};

}  // namespace

void CloudComparerOptions::Bind(OptionTable* table) {
  constexpr double kMax = 1e12;
  table->AddRequired("input_path", &input_path, "cloud to be judged, PLY");
  table->AddRequired("reference_path", &reference_path, "cloud to judge it by, PLY, same frame");
  table->AddRequired("output_path", &output_path, "JSON file with every figure and its definition");
  table->Add("difference_path", &difference_path,
             "folder for both clouds coloured by distance, and a picture; empty = none", "ours");
  table->Add("distances", &distances,
             "a,b,c: accuracy, completeness and F-score at these, in units of the clouds; empty = "
             "1, 2 and 4 times the reference's spacing (median distance to the next point)",
             "ours");
  table->Add("max_distance", &compare.max_distance,
             "units; what is farther counts as beyond; 0 = 10 times the largest distance", "ours",
             0, kMax);
  table->Add("voxel_size", &compare.voxel_size,
             "units, side of ETH3D's voxels; 0 = the smallest distance", "ETH3D", 0, kMax);
  table->Add("cell_size", &compare.cell_size,
             "units, side of the cells of redundancy; 0 = the reference's spacing", "ours", 0,
             kMax);
  table->Add("area_cell_size", &compare.area_cell_size,
             "units, side of the cells of areas; 0 = 4 times the larger spacing", "ours", 0, kMax);
  table->Add("unit_in_metres", &unit_in_metres,
             "1: the clouds are in metres, so density is given per cm^2 as well", "ours");
  run.Bind(table);
  table->MarkOutput("output_path");
  table->MarkOutput("difference_path");
}

CommandResult RunCloudComparer(const CloudComparerOptions& options) {
  CheckOutputPaths(options);
  const CompareOptions compare = ToCompareOptions(options);
  const std::filesystem::path folder = FolderOf(options.output_path);
  CheckWritableDir(folder);
  const RunLock lock = LockFile(options.output_path, "--output_path");
  CheckReplaceable(options.output_path, kComparisonJsonWords,
                   "choose another --output_path, or remove the file");
  const auto difference_folder = ClaimDifferences(options);
  DifferenceFiles differences(options.difference_path);
  StageProgress progress;
  CompareCallbacks callbacks;
  callbacks.progress = [&](const std::string& stage, int64_t done, int64_t total) {
    progress.Update(stage, done, total);
  };
  if (!options.difference_path.empty()) {
    callbacks.begin = [&](const CompareSetup& setup) { differences.Begin(setup); };
    callbacks.difference = [&](bool of_input, const PointVector& points,
                               const std::vector<double>& squared) {
      differences.Add(of_input, points, squared);
    };
  }
  const CloudComparison comparison =
      CompareClouds(options.input_path, options.reference_path, folder, compare, callbacks);
  progress.Finish();
  if (!options.difference_path.empty()) differences.Finish();
  const ComparisonReport report = {options.input_path, options.reference_path,
                                   options.unit_in_metres, comparison};
  WriteTextFile(options.output_path, ComparisonJson(report));
  return {true, ComparisonTable(report)};
}

}  // namespace colmap_seapoint
