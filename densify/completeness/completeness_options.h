// What counts as covered.
#pragma once

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

struct CompletenessOptions {
  double spacing = 0;           // units; 0: GSD x step
  int step = 0;                 // pixels, as PartialDensification.step
  double min_confidence = 0.5;  // of a point
  double min_parallax_deg = 2;
  double forward_overlap = 0.7, side_overlap = 0.5;  // of the passes that are proposed
  bool self_check = false;                           // check_by_hiding.h

  void Bind(OptionTable* table);
};

}  // namespace colmap_seapoint
