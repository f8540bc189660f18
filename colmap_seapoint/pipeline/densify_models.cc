#include "colmap_seapoint/pipeline/densify_models.h"

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/pipeline/densify.h"
#include "densify/densify_sequence.h"

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

// What it left out could be read when SeaPoints were found in it: a disk that fails now and then.
// The next run tries again.
RunReport DensifyOnce(const PartialDensifierOptions& densifier, const Stage& stage,
                      ColmapDatabase* database, WorkspaceState* state) {
  RunReport result = RunStage<RunReport>(state, stage, [&]() -> StageOutput<RunReport> {
    RunReport report = DensifyModel(densifier, database);
    return {std::move(report), FilesOfOurs(densifier.output_path)};
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
    model.densification = DensifyOnce(densifier, stage, database, state);
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
