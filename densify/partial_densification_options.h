// What a user may set of densification.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "densify/match/plan_pair.h"

namespace colmap_seapoint {

// What a pair is compared with before it is densified.
enum class Redundancy {
  kSequential,  // the previous pair (paper 2.5)
  kAll,         // every earlier view of the same place (ours)
};

// Each field's meaning, unit, legal range and origin: Bind(), in the .cc file.
struct PartialDensificationOptions {
  std::string mode = "partial";
  std::string redundancy = "all";
  double max_overlap = 0.6;
  int step = 0;
  int window_size = 9;
  double min_zncc = 0.7;
  double influence_radius = 0.03;
  double max_expansion = 0.1;
  double min_mean_motion = 0.02;
  int min_num_seeds = 20;
  bool completion = true;
  bool write_debug = false;
  bool write_maps = false;

  void Bind(OptionTable* table);
  std::string Check() const;  // "" or the whole sentence: name, value, rule

  // What the two texts say.
  DensificationMode Mode() const;
  Redundancy AgainstWhat() const;
};

}  // namespace colmap_seapoint
