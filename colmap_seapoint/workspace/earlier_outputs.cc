#include "colmap_seapoint/workspace/earlier_outputs.h"

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/dense_workspace.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Names = std::vector<std::string>;

Json ReadJson(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return Json();
  InputStream file(path);
  return Json::parse(file, nullptr, false);
}

// Names of the entries of a folder; none where there is no such folder.
Names EntriesOf(const fs::path& folder) {
  Names names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  return names;
}

bool IsNumber(const std::string& name) {
  return !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
}

// The stages in state/ whose record is one of ours.
std::set<std::string> RecordedStages(const fs::path& state) {
  std::set<std::string> stages;
  for (const std::string& name : EntriesOf(state)) {
    const Json record = ReadJson(state / name);
    if (record.is_object() && record.contains("fingerprint")) {
      stages.insert(fs::path(name).stem().string());
    }
  }
  return stages;
}

bool Any(const std::set<std::string>& stages, const std::string& prefix) {
  const auto first = stages.lower_bound(prefix);
  return first != stages.end() && boost::starts_with(*first, prefix);
}

Names ModelsOf(const fs::path& sparse) {
  Names names = {"sparse"};
  for (const std::string& model : EntriesOf(sparse)) {
    if (!IsNumber(model)) continue;
    for (const std::string& file : EntriesOf(sparse / model)) {
      if (IsModelFile(file)) names.push_back("sparse/" + model + "/" + file);
    }
  }
  return names;
}

// The folder that the mapper worked in when it was killed.
bool IsMapperFolder(const fs::path& folder) {
  const Names entries = EntriesOf(folder);
  return std::all_of(entries.begin(), entries.end(), [](const std::string& name) {
    return IsNumber(name) || boost::starts_with(name, "trial_");
  });
}

// The option's value as that run was given it.
bool WroteMaps(const Json& report) {
  const Json options = report.value("options", Json::object());
  return options.value("PartialDensification.write_maps", std::string("0")) == "1";
}

Names DenseMapsOf(const fs::path& folder) {
  Names pictures;
  const auto list = OpenIfThere(folder / "stereo" / "fusion.cfg");
  for (std::string line; list && std::getline(*list, line);) {
    if (IsSafeImageName(line)) pictures.push_back(line);
  }
  return DenseMapNames(pictures);
}

bool IsDifferenceCloud(const fs::path& path) {
  const auto file = OpenIfThere(path);
  std::string line;
  for (int i = 0; file && i < 4 && std::getline(*file, line); ++i) {
    if (line.find("distance to the other cloud") != std::string::npos) return true;
  }
  return false;
}

}  // namespace

void AdoptEarlierWorkspace(OutputFolder* workspace) {
  const fs::path& root = workspace->Path();
  if (workspace->IsOurs("state")) return;
  const std::set<std::string> stages = RecordedStages(root / "state");
  if (EntriesOf(root / "state") == Names{"lock"}) workspace->Adopt({"state"});
  if (stages.empty()) return;
  workspace->Adopt({"state"});
  if (stages.count("database") > 0) {
    workspace->Adopt({"database.db", "report"});
    if (IsMapperFolder(root / "sparse.tmp")) workspace->Adopt({"sparse.tmp"});
  }
  const bool has_dense = Any(stages, "dense_"), has_scaled = Any(stages, "scale_");
  if (stages.count("mapper") > 0 || has_dense || has_scaled) {
    workspace->Adopt(ModelsOf(root / "sparse"));
    workspace->Adopt({"dense"});
  }
  if (has_scaled) workspace->Adopt({"sparse_scaled"});
}

void AdoptEarlierOutputs(OutputFolder* folder) {
  const fs::path& root = folder->Path();
  if (folder->IsOurs("run.json") || folder->IsOurs("input_to_reference.ply")) return;
  const Json report = ReadJson(root / "run.json");
  const std::string command = report.is_object() ? report.value("command", std::string()) : "";
  if (command == "partial_densifier") {
    folder->Adopt(CloudNames());
    folder->Adopt({"debug"});
    if (WroteMaps(report)) folder->Adopt(DenseMapsOf(root));
  } else if (command == "model_scaler") {
    folder->Adopt(ScaledModelNames());
  } else if (IsDifferenceCloud(root / "input_to_reference.ply")) {
    folder->Adopt(DifferenceNames());
  }
}

void RemoveOutputs(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return;
  {
    OutputFolder ours(folder, "--workspace_path");
    AdoptEarlierOutputs(&ours);
    RemoveOurs(&ours);
  }
  fs::remove(folder, ignored);
}

}  // namespace colmap_seapoint
