#include "colmap_seapoint/commands/run_mapper.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <set>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/commands/adjust_principal_point.h"
#include "colmap_seapoint/io/atomic_file.h"
#include "colmap_seapoint/io/colmap_model.h"
#include "colmap_seapoint/io/subprocess.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxRounds = 5;
constexpr size_t kMinPicturesOfModel = 3;
// Relaxed thresholds let pass models of a handful of chance points.
constexpr size_t kMinPointsOfModel = 50;

void RemoveAll(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (!error) return;
  throw Error(path.string(), "cannot be removed (" + error.message() + ")",
              "remove it by hand, or choose another --workspace_path");
}

void Rename(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (!error) return;
  throw Error(from.string(), "cannot be renamed to " + to.string() + " (" + error.message() + ")",
              "check the folder's permissions");
}

// "Registering image #3 (4)" (3.8), "Registering frame #3 (num_reg_frames=4)" (later): how many
// pictures the present model has.
std::optional<int> NumRegistered(const std::string& line) {
  const size_t what = line.find("Registering ");
  if (what == std::string::npos) return std::nullopt;
  const size_t open = line.find('(', what);
  if (open == std::string::npos) return std::nullopt;
  const size_t digits = line.find_first_of("0123456789", open);
  if (digits == std::string::npos) return std::nullopt;
  return std::atoi(line.c_str() + digits);
}

// What all rounds know of each other.
class MapperRounds {
 public:
  MapperRounds(const ColmapProgram& colmap, const MapperJob& job)
      : colmap_(colmap),
        job_(job),
        folder_(job.output_path.string() + ".tmp"),
        missing_(job.pictures.begin(), job.pictures.end()) {
    RemoveAll(folder_);
    fs::create_directories(folder_);
  }

  void Run() {
    for (int round = 1; round <= kMaxRounds; ++round) {
      const bool found_model = RunRound(round);
      if (missing_.size() < kMinPicturesOfModel || (!found_model && round > 1)) break;
    }
    if (num_models_ == 0) {
      throw Error(job_.database_path.string(), "the mapper found no model (" + end_ + ")",
                  "take pictures that overlap more, or relax --Mapper.abs_pose_min_num_inliers; "
                  "its output is in " +
                      LogOf(1).string());
    }
    RemoveAll(job_.output_path);
    Rename(folder_, job_.output_path);
  }

 private:
  fs::path LogOf(int round) const {
    return job_.log_folder / ("mapper_" + std::to_string(round) + ".log");
  }

  const MapperOptions& OptionsOf(int round) const {
    return round == 1 ? job_.first_round : job_.later_rounds;
  }

  std::vector<std::string> Arguments(int round, const fs::path& output) const {
    std::vector<std::string> arguments = {
        "mapper",       "--database_path",        job_.database_path.string(),
        "--image_path", job_.image_path.string(), "--output_path",
        output.string()};
    if (round > 1) {
      const fs::path list = output / "pictures.txt";
      std::string names;
      for (const std::string& name : missing_) names += name + "\n";
      WriteTextFile(list, names);
      arguments.insert(arguments.end(), {"--image_list_path", list.string()});
    }
    for (const auto& [name, value] : OptionsOf(round)) {
      arguments.insert(arguments.end(), {"--" + name, value});
    }
    return arguments;
  }

  bool RunRound(int round) {
    const fs::path output = folder_ / "round";
    fs::create_directories(output);
    Progress progress("Pictures registered by colmap mapper",
                      static_cast<int64_t>(missing_.size()));
    std::string last_line;
    const auto read_line = [&](const std::string& line) {
      if (!line.empty()) last_line = line;
      if (const auto count = NumRegistered(line)) progress.Update(*count);
    };
    const auto result =
        RunSubprocess(colmap_.path, Arguments(round, output), LogOf(round), read_line);
    end_ = result.Text() + ", '" + last_line + "'";
    std::vector<fs::path> models = ListModels(output);
    if (!CheckResult(result, last_line, !models.empty(), round)) models.clear();
    const size_t num_before = missing_.size();
    const int num_models_before = num_models_;
    for (const fs::path& model : models) TakeModel(model, OptionsOf(round));
    RemoveAll(output);
    const int num_taken = num_models_ - num_models_before;
    LogInfo("Mapper, round " + std::to_string(round) + ": " +
            std::to_string(num_before - missing_.size()) + " of " + std::to_string(num_before) +
            " pictures in " + std::to_string(num_taken) + " models");
    return num_taken > 0;
  }

  // Whether what the mapper left can be used. Having found no model is no failure here: COLMAP 3.8
  // exits with 1 for that.
  bool CheckResult(const SubprocessResult& result, const std::string& last_line, bool found_model,
                   int round) const {
    if (last_line.find("parse options") != std::string::npos ||
        last_line.find("Invalid options") != std::string::npos) {
      throw UsageError("--Mapper: " + colmap_.path.string() + " refuses a value: " + last_line);
    }
    if (result.signal_number == 0 && (result.exit_code == 0 || !found_model)) return true;
    const std::string finding = "the mapper failed (" + end_ + ")";
    if (round > 1) {
      // The models of the rounds before stand.
      LogWarning(finding + " in round " + std::to_string(round) + "; its output is in " +
                 LogOf(round).string());
      return false;
    }
    throw Error(colmap_.path.string(), finding,
                "read its output in " + LogOf(round).string() + " and run the same command again");
  }

  void TakeModel(const fs::path& model, const MapperOptions& options) {
    const SparseModel sparse = ReadSparseModel(model);
    if (sparse.points3D.size() < kMinPointsOfModel) return;
    for (const PosedImage& image : sparse.images) missing_.erase(image.name);
    const std::string name = std::to_string(num_models_++);
    if (job_.adjust_principal_point) {
      const AdjustmentJob adjustment = {job_.database_path, job_.image_path, options,
                                        job_.log_folder / ("adjustment_" + name + ".log")};
      LogInfo("Lens of model " + name + ": " + AdjustPrincipalPoint(colmap_, adjustment, model));
    }
    Rename(model, folder_ / name);
  }

  const ColmapProgram& colmap_;
  const MapperJob& job_;
  fs::path folder_;
  std::set<std::string> missing_;  // pictures in no model yet
  int num_models_ = 0;
  std::string end_;  // how the last round ended
};

}  // namespace

void RunMapper(const ColmapProgram& colmap, const MapperJob& job) {
  MapperRounds(colmap, job).Run();
}

std::vector<fs::path> ListModels(const fs::path& sparse) {
  std::vector<fs::path> models;
  std::error_code error;
  for (fs::directory_iterator entry(sparse, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_directory() && IsSparseModel(entry->path())) models.push_back(entry->path());
  }
  std::sort(models.begin(), models.end(), [](const fs::path& a, const fs::path& b) {
    return NaturalLess(a.filename().string(), b.filename().string());
  });
  return models;
}

}  // namespace colmap_seapoint
