#include "colmap_seapoint/pipeline/scale_models.h"

#include <map>
#include <optional>
#include <sstream>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/markers/detect_markers.h"
#include "colmap_seapoint/pictures/find_markers.h"
#include "colmap_seapoint/workspace/earlier_outputs.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// All that the pictures' EXIF says, where it is asked.
std::string RecordsText(const PictureRecords& records) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& [name, position] : records.gps.positions.positions) {
    text << name << " " << position.transpose() << "\n";
  }
  for (const PictureTime& time : records.times) text << time.image << time.time.seconds << "\n";
  return HashText(text.str());
}

std::string Inputs(const ModelScalerOptions& scaler, const PictureRecords& records,
                   const std::string& mapper_fingerprint) {
  const ScaleSources& sources = scaler.sources;
  std::string text = mapper_fingerprint + "," + scaler.rig + "," +
                     std::to_string(scaler.run.random_seed) + "," +
                     OptionsFingerprint(OptionValues(sources));
  for (const std::string& path : {sources.scale_bars_path, sources.targets_path,
                                  sources.positions_path, sources.nav_times, scaler.markers_path}) {
    if (!path.empty() && path != kNoPositions) text += DescribeInput(path, path).hash + ",";
  }
  std::istringstream logs(sources.nav);
  for (std::string path; std::getline(logs, path, ',');) text += DescribeInput(path, path).hash;
  if (!sources.Any() || !sources.nav.empty()) text += RecordsText(records);
  return text;
}

// The stage of one model.
ScaledModel ScaleOnce(const ModelScalerOptions& scaler, const PictureRecords& records,
                      const Stage& stage, WorkspaceState* state) {
  const fs::path output = scaler.output_path;
  return RunStage<ScaledModel>(state, stage, [&]() -> StageOutput<ScaledModel> {
    RemoveOutputs(output);
    ScaledModel scaled = ScaleModel(scaler, records);
    if (!scaled.refused.empty()) {
      RemoveOutputs(output);
      return {std::move(scaled), {}};
    }
    return {std::move(scaled), FilesOfOurs(output)};
  });
}

void SetScale(const ScaledModel& scaled, const fs::path& path, const std::string& fingerprint,
              ModelSummary* model) {
  const auto units = ReadModelUnits(path);
  model->path = path;
  model->units = UnitsText(units);
  model->units_word = UnitsWord(units);
  model->scaling = scaled.line;
  model->scaling_fingerprint = fingerprint;
}

}  // namespace

void to_json(nlohmann::ordered_json& json, const ScaledModel& scaled) {
  json = {{"report", scaled.report},
          {"text", scaled.text},
          {"line", scaled.line},
          {"refused", scaled.refused}};
}

void from_json(const nlohmann::ordered_json& json, ScaledModel& scaled) {
  scaled = {json.at("report").get<RunReport>(), json.at("text"), json.at("line"),
            json.at("refused")};
}

std::vector<MarkerSighting> FindMarkersOnce(const MarkerSearch& search, const Workspace& workspace,
                                            WorkspaceState* state, RunReport* report) {
  constexpr char kStage[] = "markers";
  if (search.families.empty()) {
    state->Forget(kStage);
    state->Folder()->Remove(workspace.markers.filename().string());
    return {};
  }
  std::string inputs;
  for (const MarkerFamily family : search.families) inputs += FamilyText(family) + ",";
  std::vector<std::string> names;
  for (const RunReport::Input& picture : search.pictures) {
    inputs += "\n" + picture.name + " " + picture.hash;
    if (!picture.hash.empty()) names.push_back(picture.name);
  }
  const Stage stage = {kStage, kMarkerVersion, inputs, "The pictures' markers are known already"};
  const auto part = RunStage<RunReport>(state, stage, [&]() -> StageOutput<RunReport> {
    RunReport found;
    {
      StageTimer timer(&found, kStage);
      const auto sightings =
          FindMarkers(workspace.images, names, search.families, search.num_threads, &found);
      WriteTextFile(workspace.markers, MarkersCsv(sightings));
    }
    return {std::move(found), {workspace.markers}};
  });
  AddPart(part, report);
  return ReadMarkersCsv(workspace.markers);
}

RunReport ScaleAllModels(ModelScalerOptions scaler, const PictureRecords& records,
                         const Workspace& workspace, const std::string& mapper_fingerprint,
                         WorkspaceState* state, std::vector<ModelSummary>* models) {
  RunReport report;
  const bool has_sources =
      scaler.sources.Any() || (records.HasGps() && !scaler.sources.DeclinesPositions());
  RemoveStaleStages("scale_", has_sources ? models->size() : 0, workspace.scaled, state);
  if (!has_sources) {
    std::error_code ignored;
    fs::remove(workspace.scaled, ignored);  // if nothing else is in it
    return report;
  }
  Stage stage = {"", kScalingVersion, Inputs(scaler, records, mapper_fingerprint), ""};
  std::optional<Error> first_error;
  size_t num_done = 0;
  std::map<std::string, std::vector<RunReport::LeftOut>> left_out;  // by name
  for (ModelSummary& model : *models) {
    scaler.input_path = model.path.string();
    scaler.output_path = (workspace.scaled / model.name).string();
    stage.name = "scale_" + model.name;
    stage.done = "The scaled model in " + scaler.output_path + " is there already";
    try {
      const ScaledModel scaled = ScaleOnce(scaler, records, stage, state);
      const RunReport& part = scaled.report;
      report.stages.insert(report.stages.end(), part.stages.begin(), part.stages.end());
      report.stages.back().name += " " + model.name;
      for (const auto& item : part.left_out) left_out[item.name].push_back(item);
      ++num_done;
      if (scaled.refused.empty()) {
        SetScale(scaled, scaler.output_path, StageFingerprint(stage), &model);
      } else {
        model.scaling = scaled.refused;
        LogWarning("sparse/" + model.name + " keeps its arbitrary units: " + scaled.refused);
      }
    } catch (const Error& error) {
      if (!first_error) first_error = error;
      LeaveOut("scale of sparse/" + model.name,
               std::string("its units stay arbitrary: ") + error.what(), &report);
    }
  }
  if (num_done == 0 && first_error) throw *first_error;
  // A bar lies in one model and not in the others: left out is what none could use.
  for (const auto& [name, items] : left_out) {
    if (items.size() == num_done) report.left_out.push_back(items.front());
  }
  return report;
}

}  // namespace colmap_seapoint
