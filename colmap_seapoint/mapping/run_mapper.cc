#include "colmap_seapoint/mapping/run_mapper.h"

#include <algorithm>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/mapping/add_pictures.h"
#include "colmap_seapoint/mapping/adjust_lens.h"
#include "colmap_seapoint/mapping/join_rounds.h"
#include "colmap_seapoint/mapping/mapper_process.h"
#include "colmap_seapoint/mapping/trial_plans.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxRounds = 5;
constexpr size_t kMinPicturesOfModel = 3;
// The relaxed thresholds of later rounds let models of a handful of chance points pass.
constexpr size_t kMinPointsOfModel = 50;
// One in so many may stay without a pose before another trial is made.
constexpr size_t kPicturesPerLost = 50;

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

// One run of the mapper, in a folder of its own.
struct Trial {
  fs::path folder;
  std::string command;  // of COLMAP
  fs::path triangulation_path;
  MapperOptions options;
  bool holds_distortion = false;
  bool must_succeed = false;
  fs::path continued_model;
  SparseModel part;                 // of it, as the mapper got it
  std::vector<fs::path> models;     // those of enough points
  std::vector<std::string> lenses;  // what became of each model's lens
  bool lenses_are_sound = true;
  std::set<std::string> pictures;
  size_t num_contradicted = 0;  // of them, by their own matches
  double worst_error = 0;       // of a model, root mean square, pixels
};

size_t NumPosedWell(const Trial& trial) {
  return trial.pictures.size() - std::min(trial.pictures.size(), trial.num_contradicted);
}

bool IsBetter(const Trial& a, const Trial& b) {
  if (NumPosedWell(a) != NumPosedWell(b)) return NumPosedWell(a) > NumPosedWell(b);
  if (a.lenses_are_sound != b.lenses_are_sound) return a.lenses_are_sound;
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
                      (job_.log_folder / "mapper_1.log").string());
    }
    if (job_.joins_models) {
      JoinModelsOfRounds(job_, [this](const fs::path& folder) { Polish(folder); });
    }
  }

 private:
  // A joined model gets its lens and all of its points as a model of the mapper does.
  void Polish(const fs::path& folder) const {
    if (job_.lens == LensRule::kLeaveToMapper) return;
    Trial trial;
    trial.command = kMapper;
    trial.triangulation_path = job_.database_path;
    trial.options = job_.later_rounds;
    trial.holds_distortion = true;
    trial.must_succeed = true;  // or a full disk would leave another model than the next run
    const LensAdjustment lens =
        AdjustLens(colmap_, JobOf(trial, "lens_joined_" + folder.filename().string()), folder);
    LogInfo("Lens of the joined model: " + lens.outcome);
  }

  // What is tried first may be enough.
  bool RunRound(int round) {
    Trial trial;
    std::vector<TrialPlan> plans = round == 1
                                       ? PlanFirstRound(colmap_, job_, folder_ / "trial_thinned")
                                       : PlanLaterRound(colmap_, job_);
    for (TrialPlan& plan : plans) {
      if (!IsDoubtful(trial)) break;
      if (plan.frees_distortion && !trial.holds_distortion) continue;
      if (plan.prepare) plan.prepare(&plan);
      plan.must_succeed = plan.must_succeed && trial.models.empty();
      const Trial other = RunTrial(std::to_string(round) + plan.name, plan);
      if (trial.command.empty() || IsBetter(other, trial)) trial = other;
    }
    return TakeModels("Mapper, round " + std::to_string(round), trial);
  }

  // Of a large survey a few pictures may show nothing that ties them: they are the later rounds'.
  bool IsDoubtful(const Trial& trial) const {
    if (!trial.continued_model.empty() && !trial.models.empty()) return false;
    const size_t num_missing = missing_.size() - std::min(missing_.size(), NumPosedWell(trial));
    return num_missing > missing_.size() / kPicturesPerLost || !trial.lenses_are_sound;
  }

  Trial RunTrial(const std::string& name, const TrialPlan& plan) {
    Trial trial;
    trial.folder = folder_ / ("trial_" + name);
    trial.continued_model = plan.continued_model;
    trial.part = plan.added.part;
    // A model that is continued is written to where others get a folder each.
    const fs::path output = plan.continued_model.empty() ? trial.folder : trial.folder / "0";
    fs::create_directories(output);
    if (!plan.continued_model.empty() && plan.added.names.empty()) {
      return ModelAsItIs(std::move(trial), output);
    }
    MapperCall call = CallOf(job_, plan, output, name);
    if (num_models_ > 0) call.pictures.assign(missing_.begin(), missing_.end());
    call.num_pictures = missing_.size();
    trial.command = call.command;
    trial.triangulation_path = plan.triangulation_path;
    trial.options = call.options;
    trial.holds_distortion = plan.holds_distortion;
    trial.must_succeed = plan.must_succeed;
    const MapperEnd end = RunMapperProcess(colmap_, call);
    end_ = end.text;
    if (!end.is_usable) return trial;
    for (const fs::path& model : ModelsOfTheirOwn(ListModels(trial.folder))) {
      if (!AddModel(model, name, &trial)) return WithoutModels(std::move(trial));
    }
    return trial;
  }

  // Pictures that nothing ties to the model are the next round's.
  static Trial ModelAsItIs(Trial trial, const fs::path& output) {
    for (const std::string& name : ModelFileNames()) {
      const fs::path file = trial.continued_model / name;
      if (fs::exists(file)) CopyFileAtomically(file, output / name);
    }
    const SparseModel model = ReadSparseModel(output, ModelContent::kPosesAndPoints);
    for (const PosedImage& image : model.images) trial.pictures.insert(image.name);
    trial.models.push_back(output);
    trial.lenses.emplace_back("nothing ties the new pictures to the " +
                              std::to_string(model.images.size()) + " that were there");
    return trial;
  }

  // As if the mapper had failed.
  static Trial WithoutModels(Trial trial) {
    trial.models.clear();
    trial.lenses.clear();
    trial.pictures.clear();
    return trial;
  }

  // False when what had to be done to it failed.
  bool AddModel(const fs::path& path, const std::string& trial_name, Trial* trial) const {
    SparseModel model = ReadSparseModel(path);
    std::string lens;
    if (!trial->continued_model.empty()) {
      AddedPictures added =
          AdjustAddedPictures(JobOf(*trial, trial_name), trial->continued_model, trial->part, path);
      if (!added.model) return false;
      lens = added.outcome;
      model = *std::move(added.model);
    } else if (job_.lens != LensRule::kLeaveToMapper) {
      const std::string log = "lens_" + trial_name + "_" + path.filename().string();
      LensAdjustment adjustment = AdjustLens(colmap_, JobOf(*trial, log), path);
      if (!adjustment.is_usable) return false;
      lens = (job_.lens == LensRule::kHold ? "held as given; " : "") + adjustment.outcome;
      trial->lenses_are_sound = trial->lenses_are_sound && adjustment.distortion_is_sound;
      trial->num_contradicted += adjustment.num_contradicted;
      model = std::move(adjustment.model);
    }
    for (const PosedImage& image : model.images) trial->pictures.insert(image.name);
    trial->worst_error = std::max(trial->worst_error, ReprojectionError(model));
    trial->models.push_back(path);
    trial->lenses.push_back(lens);
    return true;
  }

  AdjustmentJob JobOf(const Trial& trial, const std::string& log) const {
    AdjustmentJob job;
    job.database_path = trial.triangulation_path;
    job.image_path = job_.image_path;
    job.mask_path = job_.mask_path;
    // The triangulator knows the mapper's options, and none of the global mapper's.
    job.options = trial.command == kMapper ? trial.options : job_.first_round;
    job.log_path = job_.log_folder / log;
    job.must_succeed = trial.must_succeed;
    job.holds_lens = job_.lens == LensRule::kHold;
    job.frees_distortion = trial.holds_distortion;
    job.frees_principal_point = job_.adjusts_principal_point;
    job.prior_focals = PriorFocals(job_.database_path);
    job.num_threads = job_.num_threads;
    return job;
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

}  // namespace colmap_seapoint
