// How wrong the report is where it must predict: measured on the survey itself. Pictures are
// hidden, with all that was measured from them; the report says what is missing now; and what was
// hidden tells what truly is (ours).
#pragma once

#include "densify/completeness/judge_survey.h"

namespace colmap_seapoint {

// Below that a survey is too small to hide a run of its pictures.
inline constexpr size_t kMinPicturesToHide = 8;

// `ground`: of the whole survey, judged by the same setting. Points of `input` must tell their
// pictures. A fold costs what JudgeSurvey costs, and as much memory.
SelfCheck CheckByHiding(const CompletenessInput& input, const CompletenessOptions& options,
                        const SurveySetting& setting, const Ground& ground, int num_threads);

}  // namespace colmap_seapoint
