#include "colmap_seapoint/pipeline/scale.h"

#include <filesystem>
#include <iostream>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/cloud/transform_cloud.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/colmap_rigs.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/pictures/read_rig.h"
#include "colmap_seapoint/report/scale_report.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kScaleFile[] = "scale.json";

bool IsSamePath(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error);
}

bool NamesFolders(const std::string& rig) { return rig.find(',') != std::string::npos; }

void Validate(const ModelScalerOptions& options) {
  const ScaleSources& sources = options.sources;
  for (const std::string& problem : {sources.Check(), CheckRig(options.rig)}) {
    if (!problem.empty()) throw UsageError(problem);
  }
  if (!sources.Any()) {
    throw UsageError(
        "nothing says how large the model is: give --scale_bars_path, --positions_path or "
        "--rig_spacing");
  }
  if (NamesFolders(options.rig) && !fs::is_directory(options.image_path)) {
    throw UsageError("rig is '" + options.rig + "', it needs image_path: the folder of its two");
  }
  if (IsSamePath(options.input_path, options.output_path)) {
    throw UsageError("output_path is the input_path: the model would be lost; name another folder");
  }
  if (!options.cloud_path.empty() &&
      IsSamePath(options.cloud_path,
                 fs::path(options.output_path) / fs::path(options.cloud_path).filename())) {
    throw UsageError(
        "cloud_path lies in output_path: the cloud would be lost; name another folder");
  }
}

// The folder, without what an earlier run left there: rigs of one model beside another would be
// read as its own.
void PrepareOutput(const fs::path& output) {
  CheckWritableDir(output);
  std::error_code ignored;
  if (IsSparseModel(output) && !fs::exists(output / kScaleFile, ignored)) {
    throw Error(output.string(), "holds a model that model_scaler did not write",
                "choose another --output_path");
  }
  fs::remove(output / kUnitsFile, ignored);
  for (const std::string stem : {"cameras", "images", "points3D", "rigs", "frames"}) {
    for (const std::string extension : {".bin", ".txt"}) {
      fs::remove(output / (stem + extension), ignored);
    }
  }
}

void DescribeInputs(const ModelScalerOptions& options, RunReport* report) {
  const ScaleSources& sources = options.sources;
  for (const std::string& path : {sources.scale_bars_path, sources.targets_path,
                                  sources.positions_path, options.cloud_path}) {
    if (!path.empty()) report->inputs.push_back(DescribeInput(path, path));
  }
}

// scale.json goes first: it marks the folder as ours; units.json last: the model is whole.
void WriteResult(const ModelScalerOptions& options, const ScaleMeasurements& measurements,
                 const SimilarityEstimate& estimate, SparseModel* model) {
  const fs::path input = options.input_path, output = options.output_path;
  const Similarity3d& metric_from_model = estimate.metric_from_model;
  PrepareOutput(output);
  WriteScaleJson(output / kScaleFile, measurements, estimate);
  TransformModel(metric_from_model, model);
  TransformRigFiles(input, output, metric_from_model);
  IsBinaryModel(input) ? WriteSparseModelBinary(output, *model)
                       : WriteSparseModelText(output, *model);
  if (!options.cloud_path.empty()) {
    const fs::path cloud = options.cloud_path;
    const uint64_t count = TransformCloud(cloud, output / cloud.filename(), metric_from_model);
    LogInfo(std::to_string(count) + " points in " + (output / cloud.filename()).string());
  }
  if (!options.report_path.empty()) WriteScaleCsv(options.report_path, measurements, estimate);
  WriteModelUnits(output, measurements.units);
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
  table->Add("image_path", &image_path, "folder of the pictures; needed by --rig LEFT,RIGHT only",
             "COLMAP");
  table->Add("report_path", &report_path,
             "CSV to write, one row a measurement with its residual; empty = none", "ours");
  run.Bind(table);
}

ScaledModel ScaleModel(const ModelScalerOptions& options) {
  Validate(options);
  CheckScaleTables(options.sources);
  ScaledModel scaled;
  RunReport& report = scaled.report;
  report = StartReport("model_scaler", options, options.run);
  {
    StageTimer timer(&report, "model_scaler");
    SparseModel model = ReadSparseModel(options.input_path);
    report.images_in = report.images_used = static_cast<int64_t>(model.images.size());
    DescribeInputs(options, &report);
    const StereoRig rig = options.sources.rig_spacing > 0
                              ? ReadRig(options.rig, options.image_path, options.input_path, model)
                              : StereoRig();
    ScaleMeasurements measurements =
        GatherMeasurements(model, options.sources, rig, options.run.random_seed, &report);
    const SimilarityEstimate estimate = EstimateSimilarity(measurements.problem);
    if (!estimate.problem.empty()) {
      throw Error(options.input_path, "cannot be scaled: " + estimate.problem,
                  "give more positions, or a scale bar (--scale_bars_path)");
    }
    for (const std::string& warning : estimate.warnings) LogWarning(warning);
    if (!estimate.has_frame) {
      measurements.units = ModelUnits();
      measurements.units.is_metric = true;
    }
    measurements.units.scale_sigma_relative =
        estimate.scale_sigma / estimate.metric_from_model.scale;
    WriteResult(options, measurements, estimate, &model);
    scaled.text = ScaleText(measurements, estimate);
    scaled.line = ScaleLine(estimate);
    report.units = UnitsWord(measurements.units);
  }
  WriteRunReport(fs::path(options.output_path) / "run.json", report);
  LogInfo("The model in metres is in " + options.output_path);
  return scaled;
}

CommandResult RunModelScaler(const ModelScalerOptions& options) {
  const ScaledModel scaled = ScaleModel(options);
  return {scaled.report.left_out.empty(), scaled.text};
}

}  // namespace colmap_seapoint
