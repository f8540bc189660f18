#include "colmap_seapoint/pipeline/scale_models.h"

#include <map>
#include <optional>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/model_units.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kScaledFolder[] = "sparse_scaled";
// The option under which a stage's report keeps its summary line.
constexpr char kLine[] = "scaling";

std::string Fingerprint(const ModelScalerOptions& scaler, const std::string& mapper_fingerprint) {
  const ScaleSources& sources = scaler.sources;
  std::string text = kScalingVersion + mapper_fingerprint + "," + scaler.rig + "," +
                     std::to_string(scaler.run.random_seed) + "," +
                     OptionsFingerprint(OptionValues(sources));
  for (const std::string& path :
       {sources.scale_bars_path, sources.targets_path, sources.positions_path}) {
    if (!path.empty()) text += DescribeInput(path, path).hash + ",";
  }
  return HashText(text);
}

std::string LineOf(const RunReport& report) {
  for (const auto& [name, value] : report.options) {
    if (name == kLine) return value;
  }
  return "";
}

// The stage of one model; its report when it is done already.
RunReport ScaleOnce(const ModelScalerOptions& scaler, const std::string& stage,
                    const std::string& fingerprint, WorkspaceState* state) {
  const fs::path output = scaler.output_path;
  if (const auto done = state->ReadIfDone(stage, fingerprint);
      done && IsSparseModel(output) && fs::exists(output / kUnitsFile)) {
    LogInfo("The scaled model in " + output.string() + " is there already");
    return *done;
  }
  state->Forget(stage);
  std::error_code ignored;
  fs::remove_all(output, ignored);
  ScaledModel scaled = ScaleModel(scaler);
  scaled.report.options.emplace_back(kLine, scaled.line);
  state->Finish(stage, fingerprint, scaled.report);
  return scaled.report;
}

void RemoveStale(const fs::path& folder, size_t first, WorkspaceState* state) {
  std::error_code ignored;
  for (size_t k = first; state->Read("scale_" + std::to_string(k)); ++k) {
    state->Forget("scale_" + std::to_string(k));
    fs::remove_all(folder / std::to_string(k), ignored);
  }
  if (first == 0) fs::remove(folder, ignored);  // if nothing else is in it
}

}  // namespace

RunReport ScaleAllModels(ModelScalerOptions scaler, const fs::path& workspace,
                         const std::string& mapper_fingerprint, WorkspaceState* state,
                         std::vector<ModelSummary>* models) {
  RunReport report;
  const fs::path folder = workspace / kScaledFolder;
  RemoveStale(folder, scaler.sources.Any() ? models->size() : 0, state);
  if (!scaler.sources.Any()) return report;
  const std::string fingerprint = Fingerprint(scaler, mapper_fingerprint);
  std::optional<Error> first_error;
  size_t num_scaled = 0;
  std::map<std::string, std::vector<RunReport::LeftOut>> left_out;  // by name
  for (ModelSummary& model : *models) {
    scaler.input_path = (workspace / "sparse" / model.name).string();
    scaler.output_path = (folder / model.name).string();
    try {
      const RunReport part = ScaleOnce(scaler, "scale_" + model.name, fingerprint, state);
      report.stages.insert(report.stages.end(), part.stages.begin(), part.stages.end());
      report.stages.back().name += " " + model.name;
      for (const auto& item : part.left_out) left_out[item.name].push_back(item);
      model.path = scaler.output_path;
      const auto units = ReadModelUnits(model.path);
      model.units = UnitsText(units);
      model.units_word = UnitsWord(units);
      model.scaling = LineOf(part);
      model.scaling_fingerprint = fingerprint;
      ++num_scaled;
    } catch (const Error& error) {
      if (!first_error) first_error = error;
      LeaveOut("scale of sparse/" + model.name,
               std::string("its units stay arbitrary: ") + error.what(), &report);
    }
  }
  if (num_scaled == 0 && first_error) throw *first_error;
  // A bar lies in one model and not in the others: left out is what none could use.
  for (const auto& [name, items] : left_out) {
    if (items.size() == num_scaled) report.left_out.push_back(items.front());
  }
  return report;
}

}  // namespace colmap_seapoint
