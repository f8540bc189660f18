#include "colmap_seapoint/pipeline/scale_models.h"

#include <array>
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
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/markers/detect_markers.h"
#include "colmap_seapoint/pictures/find_markers.h"
#include "colmap_seapoint/workspace/earlier_outputs.h"
#include "colmap_seapoint/workspace/posed_pictures.h"

namespace colmap_seapoint {

static void to_json(nlohmann::ordered_json& json, const Similarity3d& similarity) {
  const Eigen::Quaterniond& q = similarity.rotation;
  const Eigen::Vector3d& t = similarity.translation;
  json = {similarity.scale, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
}

static void from_json(const nlohmann::ordered_json& json, Similarity3d& similarity) {
  const auto at = json.get<std::array<double, 8>>();
  similarity.scale = at[0];
  similarity.rotation = {at[1], at[2], at[3], at[4]};
  similarity.translation = {at[5], at[6], at[7]};
}

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

// Whatever the model, the tables and the pictures hold.
std::string OptionsText(const ModelScalerOptions& scaler) {
  return scaler.rig + "," + std::to_string(scaler.run.random_seed) + "," +
         OptionsFingerprint(OptionValues(scaler.sources));
}

std::string Inputs(const ModelScalerOptions& scaler, const PictureRecords& records,
                   const std::string& mapper_fingerprint) {
  const ScaleSources& sources = scaler.sources;
  std::string text = mapper_fingerprint + "," + OptionsText(scaler);
  for (const std::string& path : {sources.scale_bars_path, sources.targets_path,
                                  sources.positions_path, sources.nav_times, scaler.markers_path}) {
    if (!path.empty() && path != kNoPositions) text += DescribeInput(path, path).hash + ",";
  }
  std::istringstream logs(sources.nav);
  for (std::string path; std::getline(logs, path, ',');) text += DescribeInput(path, path).hash;
  if (!sources.Any() || !sources.nav.empty()) text += RecordsText(records);
  return text;
}

// How a model was scaled, for the time when pictures come in and are added to it.
struct ScaleRecord {
  std::vector<std::string> pictures;  // posed_pictures.h, of the mapper's model
  std::string inputs;                 // fingerprint of the stage
  Similarity3d metric_from_model;
  std::optional<Similarity3d> former;  // what it was to be kept to: given again when done again
};

void to_json(nlohmann::ordered_json& json, const ScaleRecord& record) {
  json = {{"pictures", record.pictures},
          {"inputs", record.inputs},
          {"metric_from_model", record.metric_from_model}};
  if (record.former) json["former"] = *record.former;
}

void from_json(const nlohmann::ordered_json& json, ScaleRecord& record) {
  json.at("pictures").get_to(record.pictures);
  json.at("inputs").get_to(record.inputs);
  json.at("metric_from_model").get_to(record.metric_from_model);
  if (json.contains("former")) record.former = json.at("former").get<Similarity3d>();
}

Stage RecordStage(const ModelScalerOptions& scaler, const std::string& name) {
  return {"scale_to_continue_" + name, kScalingVersion, OptionsText(scaler), ""};
}

fs::path UnitsFolder(const std::string& name, const WorkspaceState& state) {
  return state.StateFolder() / ("scale_" + name + "_before");
}

// nullopt where the model is not one that was scaled, with pictures behind its own.
std::optional<FormerScale> FormerScaleOf(const Stage& stage, const std::string& name,
                                         const ScaleRecord& now, const WorkspaceState& state) {
  const auto was = ResultIfDone<ScaleRecord>(state, stage);
  if (!was || !BeginWith(now.pictures, was->pictures)) return std::nullopt;
  const bool has_grown = now.pictures.size() > was->pictures.size();
  // Another table for the same pictures is a correction.
  if (!has_grown && (now.inputs != was->inputs || !was->former)) return std::nullopt;
  const auto units = ReadModelUnits(UnitsFolder(name, state));
  if (!units) return std::nullopt;
  return FormerScale{*units, has_grown ? was->metric_from_model : *was->former};
}

void RememberScale(const Stage& stage, const std::string& name, const fs::path& scaled_path,
                   const ScaleRecord& record, WorkspaceState* state) {
  const auto units = ReadModelUnits(scaled_path);
  if (!units) return;
  const fs::path folder = UnitsFolder(name, *state);
  fs::create_directories(folder);
  WriteModelUnits(folder, *units);
  FinishStage(stage, record, {folder / kUnitsFile}, state);
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
          {"refused", scaled.refused},
          {"metric_from_model", scaled.metric_from_model}};
}

void from_json(const nlohmann::ordered_json& json, ScaledModel& scaled) {
  scaled = {json.at("report").get<RunReport>(), json.at("text"), json.at("line"),
            json.at("refused"), json.at("metric_from_model").get<Similarity3d>()};
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
      const Stage record_stage = RecordStage(scaler, model.name);
      ScaleRecord record;
      record.pictures = PosedPictureLines(model.path, PictureMasks(""));
      record.inputs = StageFingerprint(stage);
      scaler.former = FormerScaleOf(record_stage, model.name, record, *state);
      const ScaledModel scaled = ScaleOnce(scaler, records, stage, state);
      const RunReport& part = scaled.report;
      report.stages.insert(report.stages.end(), part.stages.begin(), part.stages.end());
      report.stages.back().name += " " + model.name;
      for (const auto& item : part.left_out) left_out[item.name].push_back(item);
      ++num_done;
      if (scaled.refused.empty()) {
        SetScale(scaled, scaler.output_path, StageFingerprint(stage), &model);
        record.metric_from_model = scaled.metric_from_model;
        if (scaler.former) record.former = scaler.former->metric_from_model;
        RememberScale(record_stage, model.name, scaler.output_path, record, state);
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
