#include "colmap_seapoint/mapping/run_mapper.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/subprocess.h"
#include "colmap_seapoint/mapping/adjust_lens.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxRounds = 5;
constexpr size_t kMinPicturesOfModel = 3;
// The relaxed thresholds of later rounds let models of a handful of chance points pass.
constexpr size_t kMinPointsOfModel = 50;
constexpr char kMinModelSize[] = "Mapper.min_model_size";
constexpr char kNumBeginnings[] = "Mapper.init_num_trials";
constexpr char kRefineDistortion[] = "Mapper.ba_refine_extra_params";
constexpr char kGlobalRefineDistortion[] = "GlobalMapper.ba_refine_extra_params";
constexpr char kMapper[] = "mapper";

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

// How many pictures the present model has, from a line as "Registering image #3 (4)" (COLMAP 3.8)
// or "Registering frame #3 (num_reg_frames=4)" (later versions); nullopt for other lines.
std::optional<int> NumRegistered(const std::string& line) {
  const size_t what = line.find("Registering ");
  if (what == std::string::npos) return std::nullopt;
  const size_t open = line.find('(', what);
  if (open == std::string::npos) return std::nullopt;
  const size_t digits = line.find_first_of("0123456789", open);
  if (digits == std::string::npos) return std::nullopt;
  return std::atoi(line.c_str() + digits);
}

// One run of the mapper, in a folder of its own.
struct Trial {
  fs::path folder;
  std::string command;  // of COLMAP
  MapperOptions options;
  bool holds_distortion = false;
  std::vector<fs::path> models;     // those of enough points
  std::vector<std::string> lenses;  // what became of each model's lens
  bool lenses_are_sound = true;
  std::set<std::string> pictures;
  double worst_error = 0;  // of a model, root mean square, pixels
};

bool IsBetter(const Trial& a, const Trial& b) {
  if (a.pictures.size() != b.pictures.size()) return a.pictures.size() > b.pictures.size();
  return a.worst_error < b.worst_error;
}

// Those of enough points, the largest first, without those that have fewer than
// kMinPicturesOfModel pictures which no larger one has: COLMAP begins again until a model grows,
// and leaves its first attempts beside it.
std::vector<fs::path> ModelsOfTheirOwn(const std::vector<fs::path>& paths) {
  std::vector<std::pair<fs::path, std::set<std::string>>> models;
  for (const fs::path& path : paths) {
    const SparseModel model = ReadSparseModel(path);
    if (model.points3D.size() < kMinPointsOfModel) continue;
    models.push_back({path, {}});
    for (const PosedImage& image : model.images) models.back().second.insert(image.name);
  }
  std::stable_sort(models.begin(), models.end(),
                   [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  std::vector<fs::path> chosen;
  std::set<std::string> known;
  for (const auto& [path, pictures] : models) {
    const auto num_new = std::count_if(pictures.begin(), pictures.end(),
                                       [&](const auto& name) { return known.count(name) == 0; });
    if (static_cast<size_t>(num_new) < std::min(kMinPicturesOfModel, pictures.size())) continue;
    known.insert(pictures.begin(), pictures.end());
    chosen.push_back(path);
  }
  return chosen;
}

// Runs the rounds one after the other; what one has found, the next does not look for again.
class MapperRounds {
 public:
  MapperRounds(const ColmapProgram& colmap, const MapperJob& job)
      : colmap_(colmap),
        job_(job),
        folder_(job.output_path),
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
                      LogOf("1").string());
    }
  }

 private:
  fs::path LogOf(const std::string& trial) const {
    return job_.log_folder / ("mapper_" + trial + ".log");
  }

  bool RunRound(int round) {
    const std::string name = std::to_string(round);
    const bool is_first = round == 1;
    const MapperOptions& usual = is_first ? job_.first_round : job_.later_rounds;
    Trial trial;
    if (is_first && job_.global_round) {
      trial = RunTrial(kGlobalMapper, name + "_global", *job_.global_round, true, false);
    }
    const auto try_too = [&](const std::string& suffix, const MapperOptions& options,
                             bool holds_distortion, bool must_succeed) {
      if (!IsDoubtful(trial)) return;
      const Trial other = RunTrial(kMapper, name + suffix, options, holds_distortion, must_succeed);
      if (trial.command.empty() || IsBetter(other, trial)) trial = other;
    };
    if (is_first && job_.initial_pair_round) {
      try_too("_initial_pair", *job_.initial_pair_round, job_.finds_lens, false);
    }
    try_too("", usual, job_.finds_lens, is_first && trial.models.empty());
    if (is_first && trial.holds_distortion) try_too("_free_distortion", usual, false, false);
    if (const auto larger = LargerModels(usual); is_first && larger) {
      try_too("_larger_models", *larger, false, false);
    }
    return TakeModels("Mapper, round " + name, trial);
  }

  // COLMAP's way with pictures that a small model leaves over: to drop it and begin at another
  // pair, but for few of its 200 times. nullopt where that would be no other trial, or the user
  // chose.
  std::optional<MapperOptions> LargerModels(const MapperOptions& usual) const {
    if (!job_.finds_lens || usual.count(kNumBeginnings) > 0) return std::nullopt;
    for (const char* name : {kMinModelSize, kNumBeginnings}) {
      if (!colmap_.HasMapperOption(name)) return std::nullopt;
    }
    MapperOptions options = usual;
    options[kMinModelSize] = "10";
    options[kNumBeginnings] = "2";
    return options;
  }

  bool IsDoubtful(const Trial& trial) const {
    return trial.pictures.size() < missing_.size() || !trial.lenses_are_sound;
  }

  Trial RunTrial(const std::string& command, const std::string& name, const MapperOptions& options,
                 bool holds_distortion, bool must_succeed) {
    Trial trial;
    trial.folder = folder_ / ("trial_" + name);
    trial.command = command;
    trial.options = options;
    const char* refine = command == kMapper ? kRefineDistortion : kGlobalRefineDistortion;
    trial.holds_distortion = holds_distortion && colmap_.HasMapperOption(refine);
    if (trial.holds_distortion) trial.options[refine] = "0";
    fs::create_directories(trial.folder);
    Progress progress("Pictures registered by colmap mapper",
                      static_cast<int64_t>(missing_.size()));
    std::string last_line;
    const auto read_line = [&](const std::string& line) {
      if (!line.empty()) last_line = line;
      if (const auto count = NumRegistered(line)) progress.Update(*count);
    };
    const auto result = RunSubprocess(colmap_.path, Arguments(trial), LogOf(name), read_line,
                                      colmap_.timeout_seconds);
    end_ = result.Text() + ", '" + last_line + "'";
    const std::vector<fs::path> models = ListModels(trial.folder);
    if (!CheckResult(result, last_line, !models.empty(), LogOf(name), must_succeed)) return trial;
    for (const fs::path& model : ModelsOfTheirOwn(models)) AddModel(model, name, &trial);
    return trial;
  }

  void AddModel(const fs::path& path, const std::string& trial_name, Trial* trial) const {
    SparseModel model = ReadSparseModel(path);
    std::string lens;
    if (job_.finds_lens) {
      const std::string log = "lens_" + trial_name + "_" + path.filename().string();
      LensAdjustment adjustment = AdjustLens(colmap_, JobOf(*trial, log), path);
      lens = adjustment.outcome;
      trial->lenses_are_sound = trial->lenses_are_sound && adjustment.distortion_is_sound;
      model = std::move(adjustment.model);
    }
    for (const PosedImage& image : model.images) trial->pictures.insert(image.name);
    trial->worst_error = std::max(trial->worst_error, ReprojectionError(model));
    trial->models.push_back(path);
    trial->lenses.push_back(lens);
  }

  AdjustmentJob JobOf(const Trial& trial, const std::string& log) const {
    AdjustmentJob job;
    job.database_path = job_.database_path;
    job.image_path = job_.image_path;
    // The triangulator knows the mapper's options, and none of the global mapper's.
    job.options = trial.command == kMapper ? trial.options : job_.first_round;
    job.log_path = job_.log_folder / log;
    job.frees_distortion = trial.holds_distortion;
    job.frees_principal_point = job_.adjusts_principal_point;
    return job;
  }

  std::vector<std::string> Arguments(const Trial& trial) const {
    std::vector<std::string> arguments = {
        trial.command,        "--database_path",        job_.database_path.string(),
        "--image_path",       job_.image_path.string(), "--output_path",
        trial.folder.string()};
    if (num_models_ > 0) {
      const fs::path list = trial.folder / "pictures.txt";
      std::string names;
      for (const std::string& name : missing_) names += name + "\n";
      WriteTextFile(list, names);
      arguments.insert(arguments.end(), {"--image_list_path", list.string()});
    }
    AppendOptions(trial.options, &arguments);
    return arguments;
  }

  // Whether what the mapper left can be used. That it found no model is no failure here, though
  // COLMAP 3.8 exits with 1 for it.
  bool CheckResult(const SubprocessResult& result, const std::string& last_line, bool found_model,
                   const fs::path& log, bool must_succeed) const {
    if (last_line.find("parse options") != std::string::npos ||
        last_line.find("Invalid options") != std::string::npos) {
      throw UsageError("--Mapper: " + colmap_.path.string() + " refuses a value: " + last_line);
    }
    if (result.signal_number == 0 && (result.exit_code == 0 || !found_model)) return true;
    const std::string finding = "the mapper failed (" + end_ + ")";
    if (must_succeed) {
      throw Error(colmap_.path.string(), finding,
                  "read its output in " + log.string() + " and run the same command again");
    }
    // What earlier rounds and trials have found stands.
    LogWarning(finding + "; its output is in " + log.string());
    return false;
  }

  // Numbers the trial's models on, and strikes their pictures off the missing ones. True when there
  // were any.
  bool TakeModels(const std::string& what, const Trial& trial) {
    const size_t num_before = missing_.size();
    for (size_t i = 0; i < trial.models.size(); ++i) {
      const std::string name = std::to_string(num_models_++);
      Rename(trial.models[i], folder_ / name);
      if (!trial.lenses[i].empty()) LogInfo("Lens of model " + name + ": " + trial.lenses[i]);
    }
    for (const std::string& name : trial.pictures) missing_.erase(name);
    LogInfo(what + ": " + std::to_string(num_before - missing_.size()) + " of " +
            std::to_string(num_before) + " pictures in " + std::to_string(trial.models.size()) +
            " models");
    // The folders of all trials of the round: the one taken is empty now, the others are not
    // wanted.
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().filename().string().rfind("trial_", 0) == 0) RemoveAll(entry.path());
    }
    return !trial.models.empty();
  }

  const ColmapProgram& colmap_;
  const MapperJob& job_;
  fs::path folder_;
  std::set<std::string> missing_;  // pictures in no model yet
  int num_models_ = 0;
  std::string end_;  // how the last trial ended
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
