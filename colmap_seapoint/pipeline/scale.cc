#include "colmap_seapoint/pipeline/scale.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/georeference/marker_search.h"
#include "colmap_seapoint/io/cloud/transform_cloud.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/colmap_rigs.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/same_file.h"
#include "colmap_seapoint/navigation/measured_positions.h"
#include "colmap_seapoint/pictures/find_markers.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/pictures/read_rig.h"
#include "colmap_seapoint/report/scale_report.h"
#include "colmap_seapoint/workspace/earlier_outputs.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kScaleFile[] = "scale.json";

bool NamesFolders(const std::string& rig) { return rig.find(',') != std::string::npos; }

void Validate(const ModelScalerOptions& options, const PictureRecords& records) {
  const ScaleSources& sources = options.sources;
  for (const std::string& problem : {sources.Check(), CheckRig(options.rig)}) {
    if (!problem.empty()) throw UsageError(problem);
  }
  if (!sources.Any() && (sources.DeclinesPositions() ||
                         (!records.HasGps() && !fs::is_directory(options.image_path)))) {
    throw UsageError(
        "nothing says how large the model is: give --scale_bars_path, --positions_path, --nav, "
        "--marker_size or --rig_spacing, or the --image_path of pictures with GPS");
  }
  if (NamesFolders(options.rig) && !fs::is_directory(options.image_path)) {
    throw UsageError("rig is '" + options.rig + "', it needs image_path: the folder of its two");
  }
  if (!options.cloud_path.empty() &&
      IsSameFile(options.cloud_path,
                 fs::path(options.output_path) / fs::path(options.cloud_path).filename())) {
    throw UsageError(
        "cloud_path lies in output_path: the cloud would be lost; name another folder");
  }
}

// Coded markers need pictures, or the table of what was found in them.
void CheckMarkerSource(const ModelScalerOptions& options) {
  if (FamiliesToFind(options.sources).empty()) return;
  if (!options.markers_path.empty()) {
    ReadMarkersCsv(options.markers_path);
  } else if (options.image_path.empty()) {
    throw UsageError(
        "coded markers are to be found: give --image_path, the folder of the pictures, or "
        "--markers_path, the table of marker_finder");
  } else if (!fs::is_directory(options.image_path)) {
    throw Error(options.image_path, "there is no such folder", "check --image_path");
  }
}

// Before anything is computed. `scaled_name` of the cloud: "" without one.
void ClaimOutputs(const ModelScalerOptions& options, OutputFolder* folder) {
  AdoptEarlierOutputs(folder);
  std::vector<std::string> names = ScaledModelNames();
  if (!options.cloud_path.empty()) {
    const std::string cloud = fs::path(options.cloud_path).filename().string();
    names.insert(names.end(), {cloud, cloud + ".vis"});
  }
  folder->Claim(names);
  if (options.report_path.empty()) return;
  CheckReplaceable(options.report_path, kScaleCsvHeader,
                   "choose another --report_path, or remove the file");
}

// A table holds every picture of the dive: those of other models tell why a bar is not in this one.
// Without one the model's own pictures are looked through.
std::vector<MarkerSighting> SightingsFor(const ModelScalerOptions& options,
                                         const SparseModel& model, RunReport* report) {
  const std::vector<MarkerFamily> families = FamiliesToFind(options.sources);
  if (families.empty()) return {};
  if (!options.markers_path.empty()) return ReadMarkersCsv(options.markers_path);
  std::vector<std::string> names;
  for (const PosedImage& image : model.images) names.push_back(image.name);
  std::sort(names.begin(), names.end());
  return FindMarkers(options.image_path, names, families, options.run.num_threads, report);
}

void DescribeInputs(const ModelScalerOptions& options, RunReport* report) {
  const ScaleSources& sources = options.sources;
  for (const std::string& path :
       {sources.scale_bars_path, sources.targets_path, sources.positions_path, options.markers_path,
        options.cloud_path, sources.nav_times}) {
    if (!path.empty() && path != kNoPositions) report->inputs.push_back(DescribeInput(path, path));
  }
}

// What an earlier run left there goes first: rigs of one model beside another would be read as its
// own. units.json comes last: the model is whole then.
void WriteResult(const ModelScalerOptions& options, const ScaleMeasurements& measurements,
                 const SimilarityEstimate& estimate, OutputFolder* folder, SparseModel* model) {
  const fs::path input = options.input_path, output = folder->Path();
  const Similarity3d& metric_from_model = estimate.metric_from_model;
  for (const std::string& name : ScaledModelNames()) folder->Remove(name);
  ClaimOutputs(options, folder);
  WriteScaleJson(output / kScaleFile, measurements, estimate);
  TransformModel(metric_from_model, model);
  IsBinaryModel(input) ? WriteSparseModelBinary(output, *model)
                       : WriteSparseModelText(output, *model);
  TransformRigFiles(input, output, metric_from_model);
  if (!options.cloud_path.empty()) {
    const fs::path cloud = options.cloud_path;
    const uint64_t count = TransformCloud(cloud, output / cloud.filename(), metric_from_model);
    LogInfo(std::to_string(count) + " points in " + (output / cloud.filename()).string());
  }
  if (!options.report_path.empty()) WriteScaleCsv(options.report_path, measurements, estimate);
  WriteModelUnits(output, measurements.units);
}

struct Estimation {
  std::string refused;              // as ScaledModel's
  std::string source, source_line;  // where positions of no table are from, for both texts
  ScaleMeasurements measurements;
  SimilarityEstimate estimate;
};

std::string Refusal(const ScaleSources& sources, const std::string& problem) {
  const std::string who =
      sources.nav.empty() ? "the GPS in the pictures" : "the log " + sources.nav;
  return who + " is not used: " + problem;
}

// What a log or EXIF says may be of no use: then the other sources count, or the model stays as it
// is. What a table of the user's says must give a scale.
Estimation Estimate(const ModelScalerOptions& options, const PictureRecords& records,
                    const SparseModel& model, RunReport* report) {
  const ScaleSources& sources = options.sources;
  const PositionSource positions = FindPositions(sources, records, model);
  Estimation found;
  const bool is_usable = positions.is_there && positions.problem.empty();
  const bool has_others = !sources.scale_bars_path.empty() || sources.rig_spacing > 0 ||
                          sources.marker_size > 0 || sources.HasPositionTable();
  if (!is_usable) {
    found.refused = Refusal(sources, positions.is_there ? positions.problem : "there is none");
    if (!sources.nav.empty()) LeaveOut(sources.nav, positions.problem, report);
    if (!has_others) return found;
    found.refused.clear();
  } else {
    LogInfo("Positions " + positions.text);
    found.source = "positions: " + positions.text + "\n";
    found.source_line = positions.text + "; ";
  }
  const StereoRig rig = sources.rig_spacing > 0
                            ? ReadRig(options.rig, options.image_path, options.input_path, model)
                            : StereoRig();
  found.measurements = GatherMeasurements(
      model, sources, SightingsFor(options, model, report), rig, options.run.random_seed, report,
      is_usable ? &positions.measured : nullptr, options.former ? &*options.former : nullptr);
  found.estimate = EstimateSimilarity(found.measurements.problem);
  const std::string doubt = is_usable && !has_others ? Doubt(found.estimate) : "";
  if (!doubt.empty()) {
    found.refused = Refusal(sources, doubt);
    if (!sources.nav.empty()) LeaveOut(sources.nav, doubt, report);
    return found;
  }
  if (!found.estimate.problem.empty()) {
    throw Error(options.input_path, "cannot be scaled: " + found.estimate.problem,
                "give more positions, or a scale bar (--scale_bars_path)");
  }
  for (const std::string& warning : found.estimate.warnings) LogWarning(warning);
  ModelUnits& units = found.measurements.units;
  if (!found.estimate.has_frame) {
    units = ModelUnits();
    units.is_metric = true;
  }
  units.scale_sigma_relative = found.estimate.scale_sigma / found.estimate.metric_from_model.scale;
  return found;
}

// Of the model's pictures.
PictureRecords ReadRecords(const ModelScalerOptions& options) {
  if (!fs::is_directory(options.image_path)) return {};
  std::vector<std::string> names;
  for (const PosedImage& image :
       ReadSparseModel(options.input_path, ModelContent::kPosesAndPoints).images) {
    names.push_back(image.name);
  }
  RunReport ignored;  // a picture that is not there tells nothing, and is not needed
  return RecordsFromExif(ReadHeaders(options.image_path, names, options.run.num_threads, &ignored));
}

}  // namespace

void ModelScalerOptions::Bind(OptionTable* table) {
  table->AddRequired("input_path", &input_path, "COLMAP model, binary or text");
  table->AddRequired("output_path", &output_path,
                     "folder for the scaled model, units.json, scale.json and run.json");
  table->Add("cloud_path", &cloud_path,
             "cloud in the model's frame (PLY), scaled into output_path; empty = none", "ours");
  sources.Bind(table);
  table->Add("rig", &rig, kRigHelp, "paper 4");
  table->Add("image_path", &image_path,
             "folder of the pictures; for coded markers, for --rig LEFT,RIGHT, for the times of "
             "--nav, and for their GPS where no other source is given",
             "COLMAP");
  table->Add("markers_path", &markers_path,
             "coded markers of the pictures as marker_finder has written them; empty = they are "
             "looked for in image_path where a scale bar or marker_size needs them",
             "ours");
  table->Add("report_path", &report_path,
             "CSV to write, one row a measurement with its residual; empty = none", "ours");
  run.Bind(table);
  table->MarkOutput("output_path");
  table->MarkOutput("report_path");
}

ScaledModel ScaleModel(const ModelScalerOptions& options, const PictureRecords& records) {
  Validate(options, records);
  CheckScaleTables(options.sources);
  CheckMarkerSource(options);
  OutputFolder folder(options.output_path, "--output_path");
  ClaimOutputs(options, &folder);
  ScaledModel scaled;
  scaled.report = StartReport("model_scaler", options, options.run);
  {
    StageTimer timer(&scaled.report, "model_scaler");
    SparseModel model = ReadSparseModel(options.input_path);
    scaled.report.images_in = scaled.report.images_used = static_cast<int64_t>(model.images.size());
    DescribeInputs(options, &scaled.report);
    Estimation found = Estimate(options, records, model, &scaled.report);
    if (!found.refused.empty()) {
      scaled.refused = found.refused;
      return scaled;
    }
    WriteResult(options, found.measurements, found.estimate, &folder, &model);
    scaled.text = found.source + ScaleText(found.measurements, found.estimate);
    scaled.line = found.source_line + ScaleLine(found.measurements, found.estimate);
    scaled.metric_from_model = found.estimate.metric_from_model;
    scaled.report.units = UnitsWord(found.measurements.units);
  }
  WriteRunReport(fs::path(options.output_path) / "run.json", scaled.report);
  LogInfo("The model in metres is in " + options.output_path);
  return scaled;
}

CommandResult RunModelScaler(const ModelScalerOptions& options) {
  CheckOutputPaths(options);
  PictureRecords records;
  if (!options.sources.Any() || !options.sources.nav.empty()) records = ReadRecords(options);
  const ScaledModel scaled = ScaleModel(options, records);
  if (!scaled.refused.empty()) {
    throw Error(options.input_path, "cannot be scaled: " + scaled.refused,
                "give --positions_path, or a scale bar (--scale_bars_path)");
  }
  return {scaled.report.left_out.empty(), scaled.text};
}

}  // namespace colmap_seapoint
