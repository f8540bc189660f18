// What came of hiding pictures from the report (check_by_hiding.h).
#pragma once

namespace colmap_seapoint {

struct SelfCheck {
  int num_folds = 0;       // 0: nothing was checked
  double hidden_area = 0;  // units^2 of covered surface that went with the pictures, over all folds
  double beyond_share = 0;  // of it: beyond the outline of what was left, which nobody can miss
  double found_share = 0;   // of the rest: said to be missing
  double false_share = 0;   // of what was said to be missing in addition: no part of the survey
  // Said over true area that is missing, less 1: root of the mean square over the folds.
  double area_error = 0;
};

}  // namespace colmap_seapoint
