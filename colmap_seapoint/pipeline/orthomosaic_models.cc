#include "colmap_seapoint/pipeline/orthomosaic_models.h"

#include <system_error>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/orthomosaic/ground/no_map.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"
#include "colmap_seapoint/pipeline/orthomosaic/former_map.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_maker.h"
#include "colmap_seapoint/workspace/earlier_outputs.h"
#include "colmap_seapoint/workspace/posed_pictures.h"
#include "densify/densify_sequence.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kStages[] = "map_";

struct MapOutcome {
  MadeMap map;
  std::string refused;  // why there is none; empty: there is one
};

void to_json(nlohmann::ordered_json& json, const MapOutcome& outcome) {
  json = {{"report", outcome.map.report}, {"line", outcome.map.line}, {"refused", outcome.refused}};
}

void from_json(const nlohmann::ordered_json& json, MapOutcome& outcome) {
  outcome = {{json.at("report").get<RunReport>(), json.at("line")}, json.at("refused")};
}

OrthomosaicMakerOptions MakerOptions(const AutomaticReconstructorOptions& options,
                                     const Workspace& workspace, const ModelSummary& model) {
  OrthomosaicMakerOptions maker;
  maker.image_path = workspace.images.string();
  maker.input_path = model.path.string();
  maker.cloud_path = model.cloud_path.string();
  maker.output_path = (workspace.maps / model.name).string();
  maker.mask_path = options.reader.mask_path;
  maker.map = options.map;
  maker.run = options.run;
  return maker;
}

MapOrigin OriginOf(const AutomaticReconstructorOptions& options,
                   const OrthomosaicMakerOptions& maker, const ModelSummary& model) {
  MapOrigin origin;
  origin.name = model.name;
  origin.options = kDensificationVersion + OptionsFingerprint(OptionValues(options.densification)) +
                   OptionsFingerprint(OptionValues(options.map)) + model.units_word;
  origin.pictures = PosedPictureLines(model.path, PictureMasks(maker.mask_path));
  origin.cloud = model.cloud_path;
  origin.cloud_hash = model.cloud_hash;
  origin.folder = maker.output_path;
  return origin;
}

// Colours without the water are found from all pictures at once.
bool CanBeContinued(const MapSettings& map) { return map.color != "balanced"; }

// A picture that it left out could be read before: the next run tries again.
MapOutcome MakeMapOnce(const AutomaticReconstructorOptions& options, OrthomosaicMakerOptions maker,
                       const ModelSummary& model, const Stage& stage, WorkspaceState* state) {
  MapOutcome outcome = RunStage<MapOutcome>(state, stage, [&]() -> StageOutput<MapOutcome> {
    const MapOrigin origin = OriginOf(options, maker, model);
    if (CanBeContinued(options.map)) {
      maker.former = KeepFormerMap(origin, state);
      maker.memory_path = MemoryPathOf(origin, *state);
    }
    RemoveOutputs(maker.output_path);
    try {
      MadeMap made = MakeMap(maker);
      const bool is_whole = made.report.left_out.empty();
      if (CanBeContinued(options.map) && is_whole) RememberMap(origin, state);
      ForgetFormerMap(model.name, !is_whole, state);
      return {{std::move(made), ""}, FilesOfOurs(maker.output_path)};
    } catch (const NoMap& none) {
      RemoveOutputs(maker.output_path);
      return {{MadeMap(), none.what()}, {}};
    }
  });
  if (!outcome.map.report.left_out.empty()) state->Forget(stage.name);
  return outcome;
}

void RemoveMaps(size_t first, const Workspace& workspace, WorkspaceState* state) {
  RemoveStaleStages(kStages, first, workspace.maps, state);
  std::error_code ignored;
  fs::remove(workspace.maps, ignored);  // if nothing else is in it
}

}  // namespace

void MakeMaps(const AutomaticReconstructorOptions& options, const Workspace& workspace,
              const std::string& mapper_fingerprint, WorkspaceState* state,
              std::vector<ModelSummary>* models, RunReport* report) {
  RemoveMaps(options.makes_map ? models->size() : 0, workspace, state);
  if (!options.makes_map) return;
  CheckWritableDir(workspace.maps);
  for (ModelSummary& model : *models) {
    const OrthomosaicMakerOptions maker = MakerOptions(options, workspace, model);
    if (model.densification.points == 0) {
      state->Forget(kStages + model.name);
      RemoveOutputs(maker.output_path);
      continue;
    }
    const Stage stage = {kStages + model.name, kOrthomosaicVersion,
                         mapper_fingerprint + model.name + "," + model.scaling_fingerprint + "," +
                             model.cloud_hash +
                             PictureMasks(maker.mask_path).Fingerprint(model.pictures) +
                             OptionsFingerprint(OptionValues(options.map)),
                         "The map in " + maker.output_path + " is there already"};
    MapOutcome outcome = MakeMapOnce(options, maker, model, stage, state);
    if (!outcome.refused.empty()) {
      LeaveOut("map of sparse/" + model.name, outcome.refused, report);
      continue;
    }
    for (RunReport::Stage& part : outcome.map.report.stages) part.name += " " + model.name;
    AddPart(outcome.map.report, report);
    model.map_path = maker.output_path;
    model.map = outcome.map.line;
  }
}

}  // namespace colmap_seapoint
