// What a user may set of densification.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "densify/match/densification_mode.h"

namespace colmap_seapoint {

// What a pair is compared with before it is densified.
enum class Redundancy {
  kSequential,  // the previous pair (paper 2.5)
  kAll,         // every earlier view of the same place (ours)
};

// The legal ranges stand in the .cc file, where each field is bound to its option.
struct PartialDensificationOptions {
  std::string mode = "partial";    // partial or complete (paper 3)
  std::string redundancy = "all";  // sequential (paper 2.5) or all (ours)
  double max_overlap = 0.6;        // with the previous pair, share; above it a picture is passed
                                   // over (paper 2.5)
  int step = 0;                    // pixels between samples; 0 = 0.75 million a picture (ours)
  int window_size = 9;             // of the correlation, pixels, odd (ours)
  double min_zncc = 0.7;           // smallest correlation of a match (ours)
  double min_confidence = 0.3;     // of a point: less is not written (ours)
  double influence_radius = 0.03;  // of a SeaPoint, share of the longer side (paper 2.5)
  double max_expansion = 0.1;      // of matches from a seed, share of the longer side (paper 2.6)
  double min_mean_motion = 0.02;   // mean norm of a pair's vectors, likewise (paper 2.6)
  int min_num_seeds = 20;          // matches that a pair needs (ours)
  bool completion = true;          // then what two pictures see and no pair has covered (ours)
  bool write_debug = false;        // the paper's figures of every pair (ours)
  bool write_maps = false;         // a dense workspace of COLMAP (ours)

  void Bind(OptionTable* table);
  std::string Check() const;  // "" or the whole sentence: name, value, rule

  // What the two texts say.
  DensificationMode Mode() const;
  Redundancy AgainstWhat() const;
};

}  // namespace colmap_seapoint
