#include "colmap_seapoint/pipeline/densify_models.h"

#include <algorithm>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/pipeline/densify.h"
#include "colmap_seapoint/workspace/posed_pictures.h"
#include "densify/densify_sequence.h"
#include "densify/sequence_scope.h"

namespace colmap_seapoint {
namespace {

PartialDensifierOptions DensifierOptions(const AutomaticReconstructorOptions& options,
                                         const Workspace& workspace, const ModelSummary& model) {
  PartialDensifierOptions densifier;
  densifier.image_path = workspace.images.string();
  densifier.input_path = model.path.string();
  densifier.output_path = (workspace.dense / model.name).string();
  densifier.database_path = workspace.database.string();
  densifier.mask_path = options.reader.mask_path;
  densifier.rig = options.rig;
  densifier.densification = options.densification;
  densifier.extraction = options.extraction;
  densifier.matching = options.matching;
  densifier.run = options.run;
  return densifier;
}

// A cloud and what it was made of, to be added to when pictures come in. Beside the stage's own
// record, which is forgotten as soon as the cloud has to be another one.
struct ContinuedCloud {
  std::vector<std::string> pictures;
  RunReport report;
};

void to_json(nlohmann::ordered_json& json, const ContinuedCloud& cloud) {
  json = {{"pictures", cloud.pictures}, {"report", cloud.report}};
}

void from_json(const nlohmann::ordered_json& json, ContinuedCloud& cloud) {
  cloud = {json.at("pictures").get<std::vector<std::string>>(), json.at("report").get<RunReport>()};
}

Stage CloudStage(const PartialDensifierOptions& options, const std::string& name) {
  return {"cloud_to_continue_" + name, kDensificationVersion,
          options.mask_path + OptionsFingerprint(OptionValues(options.densification)), ""};
}

// What is there already of the model's first pictures, where these stand as they stood.
EarlierCloud CloudToContinue(const PartialDensifierOptions& options, const Stage& stage,
                             const std::vector<std::string>& pictures, WorkspaceState* state) {
  if (!options.rig.empty() || !CanBeDensifiedInParts(options.densification)) return {};
  const auto known = ResultIfDone<ContinuedCloud>(*state, stage);
  if (!known || !BeginWith(pictures, known->pictures)) return {};
  const size_t num_new = pictures.size() - known->pictures.size();
  LogInfo("The cloud of " + std::to_string(known->pictures.size()) + " pictures stays as it is; " +
          std::to_string(num_new) + " add theirs");
  return {static_cast<int>(known->pictures.size()), known->report.pairs};
}

// What it left out could be read when SeaPoints were found in it: a disk that fails now and then.
// The next run tries again.
RunReport DensifyOnce(const PartialDensifierOptions& densifier, const Stage& stage,
                      const ModelSummary& model, ColmapDatabase* database, WorkspaceState* state) {
  RunReport result = RunStage<RunReport>(state, stage, [&]() -> StageOutput<RunReport> {
    const Stage cloud = CloudStage(densifier, model.name);
    const std::vector<std::string> pictures =
        PosedPictureLines(model.path, PictureMasks(densifier.mask_path));
    const EarlierCloud earlier = CloudToContinue(densifier, cloud, pictures, state);
    RunReport report = DensifyModel(densifier, database, earlier);
    const auto files = FilesOfOurs(densifier.output_path);
    if (report.left_out.empty()) {
      FinishStage(cloud, ContinuedCloud{pictures, report}, files, state);
    }
    return {std::move(report), files};
  });
  if (!result.left_out.empty()) state->Forget(stage.name);
  return result;
}

}  // namespace

void DensifyModels(const AutomaticReconstructorOptions& options, const Workspace& workspace,
                   const std::string& mapper_fingerprint, ColmapDatabase* database,
                   WorkspaceState* state, std::vector<ModelSummary>* models, RunReport* report) {
  CheckWritableDir(workspace.dense);
  RemoveStaleStages("dense_", models->size(), workspace.dense, state);
  for (ModelSummary& model : *models) {
    const PartialDensifierOptions densifier = DensifierOptions(options, workspace, model);
    const Stage stage = {"dense_" + model.name, kDensificationVersion,
                         mapper_fingerprint + model.name + "," + options.rig + "," +
                             model.scaling_fingerprint +
                             PictureMasks(densifier.mask_path).Fingerprint(model.pictures) +
                             OptionsFingerprint(OptionValues(options.densification)),
                         "The cloud in " + densifier.output_path + " is there already"};
    model.densification = DensifyOnce(densifier, stage, model, database, state);
    for (RunReport::Stage& part : model.densification.stages) part.name += " " + model.name;
    model.cloud_path = workspace.dense / model.name / "fused.ply";
    AddPart(model.densification, report);
    report->pairs += model.densification.pairs;
    report->points += model.densification.points;
    if (model.densification.points > 0) {
      model.cloud_hash = HashFile(model.cloud_path);
      continue;
    }
    LeaveOut("sparse/" + model.name,
             "no pair of this model gave a point; see dense/" + model.name + "/pairs.csv", report);
  }
  if (report->points > 0) return;
  throw Error(workspace.root.string(), "no pair of any model gave a point",
              "see why in dense/0/pairs.csv there");
}

}  // namespace colmap_seapoint
