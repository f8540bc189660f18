// partial_densifier: model + pictures -> one fused cloud, each pair adding only what is new.
#pragma once

#include <cstdint>
#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "densify/partial_densification_options.h"
#include "feature/detector/seapoint_detector.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

class ColmapDatabase;
struct RunReport;

// What an earlier run has made of the model's first pictures, in the folder of the output.
struct EarlierCloud {
  int num_pictures = 0;  // 0: nothing
  int64_t num_pairs = 0;
};

struct PartialDensifierOptions {
  std::string image_path;     // folder of the pictures
  std::string input_path;     // COLMAP model, binary or text, or a folder of several
  std::string output_path;    // folder for the cloud and its reports
  std::string database_path;  // with SeaPoints and matches; empty = they are found again
  std::string mask_path;      // folder of COLMAP's masks (picture_masks.h); empty = none
  std::string rig;            // "", "none" or "LEFT,RIGHT" (read_rig.h)
  std::string block;          // "k/N": the pairs of the k-th of N parts of the track; empty = all
  PartialDensificationOptions densification;
  SeaPointExtractionOptions extraction;
  SeaPointMatchingOptions matching;
  RunOptions run;

  void Bind(OptionTable* table);
};

// Pictures may be larger or smaller than the model's cameras, in the same proportions (paper 4,
// hybrid resolution): the cameras, and the database's SeaPoints, are scaled to them.
// Writes fused.ply, fused.ply.vis, pairs.csv, units.json (the model's own) and run.json into
// output_path, which is locked meanwhile. Throws Error when another run works there, when one of
// these files is there and not ours (before anything is read), and when no picture of the model is
// readable. When no pair gave a point,
// the report says 0 points, no cloud is written, and pairs.csv says why. `database` is the one at
// options.database_path, open; nullptr when there is none. The points and rows of an earlier cloud
// come first, as they are; the pictures that came in since add theirs (densify_sequence.h).
RunReport DensifyModel(const PartialDensifierOptions& options, ColmapDatabase* database,
                       const EarlierCloud& earlier = {});

// As DensifyModel; or, when input_path is no model but holds several (what COLMAP's mapper leaves
// in sparse/), each of them into the folder of its name below output_path.
CommandResult RunPartialDensifier(const PartialDensifierOptions& options);

}  // namespace colmap_seapoint
