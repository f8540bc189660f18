#include "colmap_seapoint/pipeline/map.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_copy.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/mapping/initial_pair.h"
#include "colmap_seapoint/mapping/mapper_process.h"
#include "colmap_seapoint/pairing/tilted_pairs.h"
#include "colmap_seapoint/pipeline/extract.h"
#include "colmap_seapoint/workspace/workspace_database.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Pictures with a verified pair.
std::vector<std::string> MatchedPictures(const ColmapDatabase& database) {
  std::set<uint32_t> ids;
  for (const ImagePair& pair : ReadVerifiedPairs(database)) ids.insert({pair.first, pair.second});
  std::vector<std::string> names;
  for (const DatabaseImage& image : ReadImages(database)) {
    if (ids.count(image.image_id) > 0) names.push_back(image.name);
  }
  return names;
}

std::string Text(const MapperOptions& options) {
  return OptionsFingerprint({options.begin(), options.end()});
}

std::string LensText(LensRule rule) {
  return rule == LensRule::kFind ? "lens" : rule == LensRule::kHold ? "held lens" : "";
}

LensRule LensRuleOf(const AutomaticReconstructorOptions& options) {
  if (GivesRefinement(options)) return LensRule::kLeaveToMapper;
  return options.reader.camera_params.empty() ? LensRule::kFind : LensRule::kHold;
}

// How it maps, whatever it maps.
std::string PlanText(const MappingPlan& plan) {
  const MapperJob& job = plan.job;
  return plan.colmap.version + LensText(job.lens) + (job.thins_matches ? "thinned" : "") +
         (job.adjusts_principal_point ? "adjusted" : "") + (job.joins_models ? "joined" : "") +
         (job.global_round ? "global" : "") + Text(job.first_round) + Text(job.later_rounds);
}

// The mapper's work depends on what the database holds, on what that was begun with, and on the
// mapper.
std::string Inputs(const MappingPlan& plan, const ColmapDatabase& database,
                   const WorkspaceState& state) {
  const auto begun = state.Read("database");
  return DatabaseFingerprint(database) + (begun ? begun->dump() : "") + PlanText(plan);
}

// What the models were made of: the id, name, camera and own SeaPoints of each picture, and what
// stands behind these (SI-SeaPoints, SeaPoints of views).
using PictureLines = std::map<std::string, std::string>;

PictureLines LinesOf(const ColmapDatabase& database) {
  PictureLines lines;
  for (const DatabaseImage& image : ReadImages(database)) {
    const std::string all = FeaturesFingerprint(database, image.image_id).value_or("");
    const size_t end = std::min(all.find(kSecondChanceMark), all.find(kTiltedMark));
    const size_t own = std::min(end, all.size());
    lines[std::to_string(image.image_id) + " " + std::to_string(image.camera_id) + " " +
          image.name + " " + all.substr(0, own)] = all.substr(own);
  }
  return lines;
}

// Whether all pictures are there with the SeaPoints that they had, be there more behind them now.
bool Continue(const PictureLines& lines, const PictureLines& before) {
  return std::all_of(before.begin(), before.end(), [&](const auto& was) {
    const auto is = lines.find(was.first);
    return is != lines.end() && is->second.rfind(was.second, 0) == 0;
  });
}

struct MadeOf {
  PictureLines pictures;
  size_t num_begun = 0;  // pictures when it was last mapped anew, not added to
};

void to_json(nlohmann::ordered_json& json, const MadeOf& made_of) {
  json = {{"pictures", made_of.pictures}, {"num_begun", made_of.num_begun}};
}

void from_json(const nlohmann::ordered_json& json, MadeOf& made_of) {
  made_of = {json.at("pictures").get<PictureLines>(), json.at("num_begun").get<size_t>()};
}

// Beside the mapper's own record, which is forgotten as soon as it has to be done again.
Stage ModelStage(const MappingPlan& plan) {
  return {"model_to_continue", kMapperVersion, PlanText(plan), ""};
}

// A model may grow by one picture at a time: what three pictures told of the lens is held up to the
// twelfth, what twelve told up to the 48th.
constexpr size_t kMaxGrowth = 4;

// Whether the cameras of all matched pictures are the model's, and at least half of the pictures
// too: what a few pictures told of the lens is not to be held for many.
bool CanTakeIn(const fs::path& model_path, const std::vector<std::string>& pictures,
               const ColmapDatabase& database) {
  const SparseModel model = ReadSparseModel(model_path, ModelContent::kPosesAndPoints);
  if (pictures.size() > 2 * model.images.size()) return false;
  const std::set<std::string> matched(pictures.begin(), pictures.end());
  for (const DatabaseImage& image : ReadImages(database)) {
    if (matched.count(image.name) > 0 && model.cameras.count(image.camera_id) == 0) return false;
  }
  return true;
}

// The model that an earlier run made of some of these pictures, as they are now and in the same
// way, where it is one alone.
std::optional<fs::path> ModelToContinue(const MappingPlan& plan, const ColmapDatabase& database,
                                        const std::optional<MadeOf>& made_of,
                                        const std::vector<fs::path>& models) {
  if (models.size() != 1 || plan.job.lens == LensRule::kLeaveToMapper || !made_of) {
    return std::nullopt;
  }
  if (!Continue(LinesOf(database), made_of->pictures)) return std::nullopt;
  if (plan.job.pictures.size() > kMaxGrowth * made_of->num_begun) return std::nullopt;
  if (!CanTakeIn(models.front(), plan.job.pictures, database)) return std::nullopt;
  return models.front();
}

// The models below `sparse` that are ours.
std::vector<fs::path> OurModels(const fs::path& sparse, const OutputFolder& workspace) {
  std::vector<fs::path> models;
  for (const fs::path& model : ListModels(sparse)) {
    const std::string name = model.lexically_relative(workspace.Path()).generic_string();
    if (workspace.IsOurs(name)) models.push_back(model);
  }
  return models;
}

// Before hours of mapping: whose model has a number for its name would be in the way of ours.
void RefuseForeignModels(const fs::path& sparse, const OutputFolder& workspace) {
  for (const fs::path& model : ListModels(sparse)) {
    const fs::path name = model.lexically_relative(workspace.Path());
    const std::string number = name.filename().string();
    if (number.find_first_not_of("0123456789") != std::string::npos) continue;
    for (const std::string& file : ModelFileNames()) {
      workspace.CheckFree({(name / file).generic_string()});
    }
  }
}

void MoveFile(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::rename(from, to, error);
  if (!error) return;
  throw Error(from.string(), "cannot be renamed to " + to.string() + " (" + error.message() + ")",
              "check the folder's permissions");
}

// The models in `from`, file by file, in place of those of ours in `sparse`. Then `from` is
// removed.
void PutModelsInPlace(const fs::path& from, const fs::path& sparse, OutputFolder* workspace) {
  const auto name_of = [&](const fs::path& path) {
    return path.lexically_relative(workspace->Path()).generic_string();
  };
  std::vector<std::pair<fs::path, fs::path>> moves;
  std::vector<std::string> names = {name_of(sparse)};
  for (const fs::path& model : ListModels(from)) {
    for (const auto& entry : fs::recursive_directory_iterator(model)) {
      if (!entry.is_regular_file()) continue;
      moves.emplace_back(entry.path(), sparse / entry.path().lexically_relative(from));
      names.push_back(name_of(moves.back().second));
    }
  }
  workspace->Remove(name_of(sparse));
  workspace->Claim(names);
  for (const auto& [source, target] : moves) MoveFile(source, target);
  std::error_code ignored;  // a leftover of it is removed by the next mapping
  fs::remove_all(from, ignored);
}

// The database as every COLMAP opens it: the workspace's own, or, where a COLMAP has made its table
// of pose priors in that, a copy without it, which is gone at the end.
class DatabaseForMapper {
 public:
  DatabaseForMapper(const ColmapDatabase& database, const fs::path& own, const fs::path& copy)
      : path_(own), copy_(copy) {
    if (!HasPosePriorTable(database)) return;
    CopyDatabase(database, copy);
    path_ = copy;
  }
  ~DatabaseForMapper() { RemoveDatabase(copy_); }
  DatabaseForMapper(const DatabaseForMapper&) = delete;
  DatabaseForMapper& operator=(const DatabaseForMapper&) = delete;

  const fs::path& Path() const { return path_; }

 private:
  fs::path path_, copy_;
};

}  // namespace

MappingPlan PlanMapping(const AutomaticReconstructorOptions& options, const Workspace& workspace) {
  MappingPlan plan;
  plan.colmap = FindColmap(options.colmap_path, options.colmap_timeout);
  const std::string problem =
      CameraModelProblem(plan.colmap, *FindCameraModel(options.reader.camera_model));
  if (!problem.empty()) {
    throw UsageError("ImageReader.camera_model: " + problem +
                     "; choose another one, or give --colmap_path of a newer COLMAP");
  }
  const int seed = options.run.random_seed;
  MapperJob& job = plan.job;
  job.lens = LensRuleOf(options);
  // We adjust the models afterwards (adjust_lens.h), unless the user says what the mapper refines:
  // its own adjustment is then the last one.
  const bool adjusts = job.lens != LensRule::kLeaveToMapper;
  const std::string effort = adjusts ? options.quality : "archive";
  job.database_path = workspace.database;
  job.image_path = workspace.images;
  job.mask_path = options.reader.mask_path;
  job.output_path = workspace.sparse.string() + ".tmp";
  plan.sparse = workspace.sparse;
  job.log_folder = workspace.report;
  job.first_round = OptionsOfRound(plan.colmap, Round::kFirst, effort, seed, options.mapper);
  job.later_rounds = OptionsOfRound(plan.colmap, Round::kLater, effort, seed, options.mapper);
  if (options.quality == "field" && job.lens == LensRule::kFind && options.mapper.empty()) {
    job.global_round = OptionsOfGlobalMapper(plan.colmap, seed);
  }
  job.thins_matches = adjusts && options.quality != "archive";
  job.adjusts_principal_point = options.adjust_principal_point;
  job.joins_models = options.join_models;
  job.num_threads = options.run.num_threads;
  return plan;
}

Mapping MapPictures(MappingPlan plan, const ColmapDatabase& database, WorkspaceState* state) {
  plan.job.pictures = MatchedPictures(database);
  if (plan.job.pictures.empty()) {
    throw Error(plan.job.image_path.string(), "no two of its pictures show the same place",
                "take pictures that overlap more, or raise --SeaPointExtraction.max_num_features");
  }
  if (const auto pair = FindInitialPair(database)) {
    plan.job.initial_pair_round = OptionsOfInitialPair(plan.colmap, plan.job.first_round, *pair);
  }
  const Stage stage = {"mapper", kMapperVersion, Inputs(plan, database, *state),
                       "The models in " + plan.sparse.string() + " are there already"};
  using Seconds = std::vector<RunReport::Stage>;
  const auto work = [&]() -> StageOutput<Seconds> {
    RefuseForeignModels(plan.sparse, *state->Folder());
    const auto made_of = ResultIfDone<MadeOf>(*state, ModelStage(plan));
    plan.job.continued_model =
        ModelToContinue(plan, database, made_of, OurModels(plan.sparse, *state->Folder()));
    RunReport report;
    {
      StageTimer timer(&report, "mapper");
      const DatabaseForMapper mapped(database, plan.job.database_path,
                                     plan.sparse.string() + ".tmp.db");
      plan.job.database_path = mapped.Path();
      RunMapper(plan.colmap, plan.job);
    }
    PutModelsInPlace(plan.job.output_path, plan.sparse, state->Folder());
    const std::vector<fs::path> models = OurModels(plan.sparse, *state->Folder());
    const size_t num_begun =
        plan.job.continued_model ? made_of->num_begun : plan.job.pictures.size();
    FinishStage(ModelStage(plan), MadeOf{LinesOf(database), num_begun}, models, state);
    return {report.stages, models};
  };
  const Seconds seconds = RunStage<Seconds>(state, stage, work);
  return {StageFingerprint(stage), OurModels(plan.sparse, *state->Folder()), seconds};
}

}  // namespace colmap_seapoint
