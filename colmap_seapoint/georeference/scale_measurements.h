// What is known of a model's size and place: scale bars, positions of its pictures, the spacing of
// a rig. Options, and the measurements that they give for one model.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/base/stereo_rig.h"
#include "colmap_seapoint/georeference/estimate_similarity.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/run_report.h"

namespace colmap_seapoint {

// Each field's meaning, unit, legal range and origin: Bind(), in the .cc file.
struct ScaleSources {
  std::string scale_bars_path;
  std::string targets_path;
  std::string positions_path;
  std::string crs;
  double rig_spacing = 0;
  double length_sigma = 0.001;
  double max_target_error = 4;

  void Bind(OptionTable* table);
  bool Any() const;
  // "", or the whole sentence about options that do not go together.
  std::string Check() const;
};

struct TargetSummary {
  std::string name;
  std::string problem;  // empty: it has a place
  size_t num_marks = 0, num_used = 0;
  double rms_pixels = 0;  // of the used marks
};

struct ScaleMeasurements {
  SimilarityProblem problem;
  std::vector<std::string> position_names, length_names;  // one a measurement, in its order
  std::vector<TargetSummary> targets;
  ModelUnits units;  // what the model's coordinates mean once it is scaled
};

// Reads all tables, so that a bad one throws its Error before hours of work, not after them.
void CheckScaleTables(const ScaleSources& sources);

// Reads the tables, triangulates the targets and finds the pictures. Pictures of the tables that
// the model does not hold (they may be in other models) are named once, on stderr; bars that do not
// have both ends in the model are left out by name. `rig` is by image_idx of `model`. Throws Error
// for a bad table, a point:ID that is not there, a mark outside its picture, a rig without
// simultaneous pictures, and when nothing of the sources is in the model.
ScaleMeasurements GatherMeasurements(const SparseModel& model, const ScaleSources& sources,
                                     const StereoRig& rig, int seed, RunReport* report);

}  // namespace colmap_seapoint
