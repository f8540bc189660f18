// model_scaler: a model (and its cloud) of arbitrary units -> metres, and east-north-up where
// positions allow.
#pragma once

#include <optional>
#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/georeference/scale_measurements.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pictures/exif_positions.h"

namespace colmap_seapoint {

struct ModelScalerOptions {
  std::string input_path;    // COLMAP model, binary or text
  std::string output_path;   // folder for the scaled model and what tells how it was scaled
  std::string cloud_path;    // PLY in the model's frame, scaled too; empty = none
  std::string image_path;    // folder of the pictures; for markers, rig LEFT,RIGHT, and their EXIF
  std::string markers_path;  // CSV of marker_finder; empty: markers are looked for in image_path
  std::string rig;           // "", "none" or "LEFT,RIGHT" (read_rig.h)
  std::string report_path;   // CSV, a row a measurement with its residual; empty = none
  ScaleSources sources;
  std::optional<FormerScale> former;  // of the model before pictures came in; set by the chain
  RunOptions run;

  void Bind(OptionTable* table);
};

struct ScaledModel {
  RunReport report;
  std::string text;  // for stdout
  std::string line;  // for a summary
  // Why the model stays as it is; empty: it is scaled. Only what the pictures' EXIF or a log says
  // may be refused; then nothing is written.
  std::string refused;
  Similarity3d metric_from_model;
};

// Writes the model (in the form it had, binary or text, with its rigs and frames), units.json,
// scale.json and run.json into output_path, and the cloud under its own name. The input is only
// read. `records` of the pictures: for a log's times, and for GPS where no other source is given.
// Throws Error when the measurements of the user's do not give a scale.
ScaledModel ScaleModel(const ModelScalerOptions& options, const PictureRecords& records = {});

CommandResult RunModelScaler(const ModelScalerOptions& options);

}  // namespace colmap_seapoint
