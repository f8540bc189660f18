#include "colmap_seapoint/pipeline/map.h"

#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/pipeline/workspace_database.h"

namespace colmap_seapoint {
namespace {

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

// The mapper's work depends on what the database holds, on what that was begun with, and on the
// mapper.
std::string Inputs(const MappingPlan& plan, const ColmapDatabase& database,
                   const WorkspaceState& state) {
  const MapperJob& job = plan.job;
  const auto begun = state.Read("database");
  return DatabaseFingerprint(database) + (begun ? begun->dump() : "") + plan.colmap.version +
         (job.finds_lens ? "lens" : "") + (job.adjusts_principal_point ? "adjusted" : "") +
         (job.global_round ? "global" : "") + Text(job.first_round) + Text(job.later_rounds);
}

}  // namespace

MappingPlan PlanMapping(const AutomaticReconstructorOptions& options, const Workspace& workspace) {
  MappingPlan plan;
  plan.colmap = FindColmap(options.colmap_path, options.colmap_timeout);
  const int seed = options.run.random_seed;
  const bool finds_lens = FindsLens(options);
  // Where the lens is ours to find, the models are adjusted by us afterwards (adjust_lens.h); where
  // it is given, the mapper's own adjustment is the last one.
  const std::string effort = finds_lens ? options.quality : "archive";
  MapperJob& job = plan.job;
  job.database_path = workspace.database;
  job.image_path = workspace.images;
  job.output_path = workspace.sparse;
  job.log_folder = workspace.report;
  job.first_round = OptionsOfRound(plan.colmap, Round::kFirst, effort, seed, options.mapper);
  job.later_rounds = OptionsOfRound(plan.colmap, Round::kLater, effort, seed, options.mapper);
  if (options.quality == "field" && finds_lens && options.mapper.empty()) {
    job.global_round = OptionsOfGlobalMapper(plan.colmap, seed);
  }
  job.finds_lens = finds_lens;
  job.adjusts_principal_point = options.adjust_principal_point;
  return plan;
}

Mapping MapPictures(MappingPlan plan, const ColmapDatabase& database, WorkspaceState* state) {
  plan.job.pictures = MatchedPictures(database);
  if (plan.job.pictures.empty()) {
    throw Error(plan.job.image_path.string(), "no two of its pictures show the same place",
                "take pictures that overlap more, or raise --SeaPointExtraction.max_num_features");
  }
  const Stage stage = {"mapper", kMapperVersion, Inputs(plan, database, *state),
                       "The models in " + plan.job.output_path.string() + " are there already"};
  using Seconds = std::vector<RunReport::Stage>;
  const auto work = [&]() -> StageOutput<Seconds> {
    RunReport report;
    {
      StageTimer timer(&report, "mapper");
      RunMapper(plan.colmap, plan.job);
    }
    return {report.stages, ListModels(plan.job.output_path)};
  };
  return {StageFingerprint(stage), RunStage<Seconds>(state, stage, work)};
}

}  // namespace colmap_seapoint
