// What is known of a model's size and place: scale bars, positions of its pictures, the spacing of
// a rig, coded markers. The measurements that the sources give for one model.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/base/stereo_rig.h"
#include "colmap_seapoint/georeference/estimate_similarity.h"
#include "colmap_seapoint/georeference/scale_sources.h"
#include "colmap_seapoint/io/files/markers_csv.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/positions_csv.h"
#include "colmap_seapoint/io/files/run_report.h"

namespace colmap_seapoint {

struct TargetSummary {
  std::string name;
  std::string problem;  // empty: it has a place
  size_t num_marks = 0, num_used = 0;
  double rms_pixels = 0;  // of the used marks
};

// Positions that no table of the user's gives: from the pictures' EXIF, or from a log.
struct MeasuredPositions {
  PicturePositions table;
  std::string from;  // "nav.csv": for messages
  std::string crs;   // of the result; empty = east, north, up of the place
};

// How the model was scaled before pictures came in.
struct FormerScale {
  ModelUnits units;
  Similarity3d metric_from_model;
};

struct ScaleMeasurements {
  SimilarityProblem problem;
  std::vector<std::string> position_names, length_names;  // one a measurement, in its order
  std::vector<TargetSummary> targets;
  ModelUnits units;  // what the model's coordinates mean once it is scaled
};

// Reads all tables, so that a bad one throws its Error before hours of work, not after them.
void CheckScaleTables(const ScaleSources& sources);

// Throws Error when no picture that positions_path, targets_path or nav_times names is among
// `names`; of some, a line says which. To be called before hours of work.
void CheckScaleNames(const ScaleSources& sources, const std::vector<std::string>& names);

// Reads the tables, triangulates the targets and finds the pictures. Pictures of the tables that
// the model does not hold (they may be in other models) are named once, on stderr; bars that do not
// have both ends in the model are left out by name. `rig` is by image_idx of `model`, `sightings`
// are the coded markers found in the pictures (of any model). Throws Error for a bad table, a
// point:ID that is not there, a mark outside its picture, a rig without simultaneous pictures, and
// when nothing of the sources is in the model. `measured`: positions that take the place of a
// table's; nullptr = none. Origin and offset of `former` are kept where its frame is of the same
// kind, and its similarity goes into the problem where the frame is the same; nullptr = none.
ScaleMeasurements GatherMeasurements(const SparseModel& model, const ScaleSources& sources,
                                     const std::vector<MarkerSighting>& sightings,
                                     const StereoRig& rig, int seed, RunReport* report,
                                     const MeasuredPositions* measured = nullptr,
                                     const FormerScale* former = nullptr);

}  // namespace colmap_seapoint
