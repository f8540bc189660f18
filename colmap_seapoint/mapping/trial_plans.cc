#include "colmap_seapoint/mapping/trial_plans.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_copy.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/mapping/adjust_lens.h"
#include "colmap_seapoint/mapping/lens_pilot.h"
#include "colmap_seapoint/mapping/measure_again.h"
#include "colmap_seapoint/tracks/thinned_database.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kMinModelSize[] = "Mapper.min_model_size";
constexpr char kNumBeginnings[] = "Mapper.init_num_trials";
constexpr char kRefineDistortion[] = "Mapper.ba_refine_extra_params";
constexpr char kGlobalRefineDistortion[] = "GlobalMapper.ba_refine_extra_params";
constexpr char kRefineFocal[] = "Mapper.ba_refine_focal_length";
constexpr char kFixExisting[] = "Mapper.fix_existing_images";
constexpr char kMaxRefinements[] = "Mapper.ba_global_max_refinements";
constexpr char kMaxLocalRefinements[] = "Mapper.ba_local_max_refinements";
constexpr char kMaxLocalIterations[] = "Mapper.ba_local_max_num_iterations";
constexpr char kMaxIterations[] = "Mapper.ba_global_max_num_iterations";
constexpr char kMinInitialAngle[] = "Mapper.init_min_tri_angle";
constexpr double kWideFocal = 0.7;  // of the longer side: 71 degrees

// Of a picture; several hundred hold it as well.
constexpr size_t kManyObservations = 2000;

// Makes the thinned database; where there are many pictures, with the lens that some of them tell.
void PrepareThinned(const ColmapProgram& colmap, const MapperJob& job, const fs::path& folder,
                    TrialPlan* plan) {
  fs::create_directories(folder / "pilot");
  {
    const ColmapDatabase database(job.database_path, ColmapDatabase::Mode::kReadOnly,
                                  ColmapDatabase::Check::kNone);
    WriteThinnedDatabase(database, {}, plan->database_path);
    const size_t num_observations =
        kMaxAdjustedObservations / std::max<size_t>(1, job.pictures.size());
    if (num_observations < kManyObservations) {
      plan->triangulation_path = folder / "triangulation.db";
      ThinningOptions options;
      options.observations_per_picture =
          std::max(options.observations_per_picture, static_cast<int>(num_observations));
      WriteThinnedDatabase(database, options, plan->triangulation_path);
    }
  }
  if (job.lens != LensRule::kFind || job.pictures.size() < kMinPicturesOfPilot) return;
  const std::map<uint32_t, Camera> lenses =
      LearnLenses(colmap, CallOf(job, *plan, folder / "pilot", "1_pilot"),
                  job.adjusts_principal_point, job.num_threads);
  if (lenses.empty()) return;
  ColmapDatabase thinned(plan->database_path, ColmapDatabase::Mode::kReadWrite,
                         ColmapDatabase::Check::kNone);
  for (const auto& [id, camera] : lenses) SetCalibration(&thinned, camera);
  thinned.Finish();
  if (colmap.HasMapperOption(kRefineFocal)) plan->options[kRefineFocal] = "0";
}

// COLMAP's way with pictures that a small model leaves over: to drop it and begin at another
// pair, but for few of its 200 times. nullopt where that would be no other trial, or the user
// chose.
std::optional<MapperOptions> LargerModels(const ColmapProgram& colmap, const MapperJob& job) {
  if (job.lens == LensRule::kLeaveToMapper || job.first_round.count(kNumBeginnings) > 0)
    return std::nullopt;
  for (const char* name : {kMinModelSize, kNumBeginnings}) {
    if (!colmap.HasMapperOption(name)) return std::nullopt;
  }
  MapperOptions options = job.first_round;
  options[kMinModelSize] = "10";
  options[kNumBeginnings] = "2";
  return options;
}

// What of the lens the mapper holds, by the job's rule.
void HoldLens(const ColmapProgram& colmap, LensRule rule, TrialPlan* plan) {
  const auto hold = [&](const char* name) {
    if (!colmap.HasMapperOption(name)) return false;
    plan->options[name] = "0";
    return true;
  };
  const bool is_global = plan->command != kMapper;
  if (rule == LensRule::kFind) {
    plan->holds_distortion = hold(is_global ? kGlobalRefineDistortion : kRefineDistortion);
  }
  if (rule == LensRule::kHold) {
    hold(kRefineFocal);
    hold(kRefineDistortion);
  }
}

// A run of COLMAP's mapper with all matches.
TrialPlan PlainPlan(const MapperJob& job, const std::string& name, const MapperOptions& options) {
  TrialPlan plan;
  plan.name = name;
  plan.database_path = plan.triangulation_path = job.database_path;
  plan.options = options;
  return plan;
}

TrialPlan GlobalPlan(const MapperJob& job) {
  TrialPlan plan = PlainPlan(job, "_global", *job.global_round);
  plan.command = kGlobalMapper;
  return plan;
}

TrialPlan ThinnedPlan(const ColmapProgram& colmap, const MapperJob& job, const fs::path& folder) {
  TrialPlan plan = PlainPlan(job, "_thinned", job.initial_pair_round.value_or(job.first_round));
  plan.must_succeed = true;
  plan.database_path = folder / "database.db";
  plan.prepare = [&colmap, &job, folder](TrialPlan* prepared) {
    PrepareThinned(colmap, job, folder, prepared);
  };
  return plan;
}

// Whether nothing is known of any lens, and there is no pilot that would tell.
bool GuessesLens(const MapperJob& job) {
  if (job.lens != LensRule::kFind || job.pictures.size() >= kMinPicturesOfPilot) return false;
  const ColmapDatabase database(job.database_path, ColmapDatabase::Mode::kReadOnly,
                                ColmapDatabase::Check::kNone);
  const auto cameras = ReadCameras(database);
  return !cameras.empty() && std::none_of(cameras.begin(), cameras.end(), [](const auto& camera) {
    return camera.second.has_prior_focal_length;
  });
}

// All matches, with a wide lens that is held until the adjustment of ours frees it. COLMAP's guess
// is a field of view of 45 degrees; action cameras have 70 and more, and from so far off few
// pictures lead the mapper to any focal length.
TrialPlan WideLensPlan(const ColmapProgram& colmap, const MapperJob& job, const fs::path& folder) {
  TrialPlan plan = PlainPlan(job, "_wide_lens", job.first_round);
  plan.options[kRefineFocal] = "0";
  // What lies across a pair's wide view is farther off than COLMAP asks for.
  if (colmap.HasMapperOption(kMinInitialAngle)) plan.options.emplace(kMinInitialAngle, "8");
  plan.prepare = [&job, folder](TrialPlan* prepared) {
    fs::create_directories(folder);
    prepared->database_path = folder / "wide_lens.db";
    CopyDatabase(ColmapDatabase(job.database_path, ColmapDatabase::Mode::kReadOnly,
                                ColmapDatabase::Check::kNone),
                 prepared->database_path);
    ColmapDatabase database(prepared->database_path, ColmapDatabase::Mode::kReadWrite,
                            ColmapDatabase::Check::kNone);
    for (const auto& [id, camera] : ReadCameras(database)) {
      const double focal = kWideFocal * std::max(camera.width, camera.height);
      Camera wide = MakeCamera(camera.model, focal, camera.width, camera.height);
      wide.camera_id = id;
      SetCalibration(&database, wide);
    }
    database.Finish();
  };
  return plan;
}

// The pictures that came in since, added to the model that there is, which stays as it is.
std::optional<TrialPlan> ContinuedPlan(const ColmapProgram& colmap, const MapperJob& job,
                                       const fs::path& folder) {
  if (!job.continued_model) return std::nullopt;
  for (const char* name : {kFixExisting, kRefineFocal, kRefineDistortion}) {
    if (!colmap.HasMapperOption(name)) return std::nullopt;
  }
  TrialPlan plan = PlainPlan(job, "_continued", job.first_round);
  plan.continued_model = *job.continued_model;
  plan.part_path = folder.parent_path() / "trial_part";
  plan.prepare = [&job](TrialPlan* prepared) {
    prepared->added = FindPicturesToAdd(job.database_path, prepared->continued_model);
    if (prepared->added.names.empty()) return;
    WriteSparseModelBinary(prepared->part_path, prepared->added.part);
  };
  plan.options[kFixExisting] = "1";
  plan.options[kRefineFocal] = plan.options[kRefineDistortion] = "0";
  // The poses around are held, and our own adjustment follows.
  const std::pair<const char*, const char*> efforts[] = {{kMaxRefinements, "1"},
                                                         {kMaxIterations, "3"},
                                                         {kMaxLocalRefinements, "1"},
                                                         {kMaxLocalIterations, "4"}};
  for (const auto& [name, value] : efforts) {
    if (colmap.HasMapperOption(name)) plan.options[name] = value;
  }
  return plan;
}

}  // namespace

std::vector<TrialPlan> PlanFirstRound(const ColmapProgram& colmap, const MapperJob& job,
                                      const fs::path& folder) {
  std::vector<TrialPlan> plans;
  const auto add = [&](TrialPlan plan) {
    HoldLens(colmap, job.lens, &plan);
    plans.push_back(std::move(plan));
  };
  if (const auto continued = ContinuedPlan(colmap, job, folder)) plans.push_back(*continued);
  if (job.global_round) add(GlobalPlan(job));
  if (job.thins_matches) add(ThinnedPlan(colmap, job, folder));
  if (job.initial_pair_round) add(PlainPlan(job, "_initial_pair", *job.initial_pair_round));
  add(PlainPlan(job, "", job.first_round));
  plans.back().must_succeed = true;
  if (GuessesLens(job) && colmap.HasMapperOption(kRefineFocal))
    add(WideLensPlan(colmap, job, folder));
  // Where a held distortion may be what keeps pictures out.
  if (job.lens == LensRule::kFind) {
    plans.push_back(PlainPlan(job, "_free_distortion", job.first_round));
    plans.back().frees_distortion = true;
  }
  if (const auto larger = LargerModels(colmap, job)) {
    plans.push_back(PlainPlan(job, "_larger_models", *larger));
    if (job.lens == LensRule::kHold) HoldLens(colmap, job.lens, &plans.back());
  }
  return plans;
}

std::vector<TrialPlan> PlanLaterRound(const ColmapProgram& colmap, const MapperJob& job) {
  TrialPlan plan = PlainPlan(job, "", job.later_rounds);
  HoldLens(colmap, job.lens, &plan);
  return {plan};
}

MapperCall CallOf(const MapperJob& job, const TrialPlan& plan, const fs::path& output_path,
                  const std::string& log_name) {
  MapperCall call;
  call.command = plan.command;
  call.input_path = plan.part_path;
  call.pictures = plan.added.names;
  call.database_path = plan.database_path;
  call.image_path = job.image_path;
  call.output_path = output_path;
  call.options = plan.options;
  call.num_pictures = job.pictures.size();
  call.log_path = job.log_folder / ("mapper_" + log_name + ".log");
  call.must_succeed = plan.must_succeed;
  return call;
}

}  // namespace colmap_seapoint
