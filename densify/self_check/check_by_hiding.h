// How wrong the report is where it must predict: measured on the survey itself. Pictures are
// hidden, with all that was measured from them; the report says what is missing now; and what was
// hidden tells what truly is (ours).
#pragma once

#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// Below that nothing is checked: a survey is too small to hide a part of it.
inline constexpr size_t kMinPicturesToHide = 4;

// Fills result->self_check, and widens result->share_tolerance by it. `result`: of the same input
// and options. Points of `input` must tell their pictures; they are read kNumFolds times
// (hidden_pictures.h). A fold costs what AssessCompleteness costs, and as much memory.
void CheckByHiding(const CompletenessInput& input, const CompletenessOptions& options,
                   int num_threads, CompletenessResult* result);

}  // namespace colmap_seapoint
