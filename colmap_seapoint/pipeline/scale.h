// model_scaler: a model (and its cloud) of arbitrary units -> metres, and east-north-up where
// positions allow.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/georeference/scale_measurements.h"
#include "colmap_seapoint/io/files/run_report.h"

namespace colmap_seapoint {

struct ModelScalerOptions {
  std::string input_path;    // COLMAP model, binary or text
  std::string output_path;   // folder for the scaled model and what tells how it was scaled
  std::string cloud_path;    // PLY in the model's frame, scaled too; empty = none
  std::string image_path;    // folder of the pictures; for rig LEFT,RIGHT and coded markers
  std::string markers_path;  // CSV of marker_finder; empty: markers are looked for in image_path
  std::string rig;           // "", "none" or "LEFT,RIGHT" (read_rig.h)
  std::string report_path;   // CSV, a row a measurement with its residual; empty = none
  ScaleSources sources;
  RunOptions run;

  void Bind(OptionTable* table);
};

struct ScaledModel {
  RunReport report;
  std::string text;  // for stdout
  std::string line;  // for a summary
};

// Writes the model (in the form it had, binary or text, with its rigs and frames), units.json,
// scale.json and run.json into output_path, and the cloud under its own name. The input is only
// read. Throws Error when the measurements do not give a scale.
ScaledModel ScaleModel(const ModelScalerOptions& options);

CommandResult RunModelScaler(const ModelScalerOptions& options);

}  // namespace colmap_seapoint
