// Steps 1 to 3 of assess_completeness.h, for a survey of which it is known what to measure it by:
// what is covered, what is missing, and why.
#pragma once

#include <vector>

#include "densify/completeness/assess_completeness.h"
#include "densify/completeness/gaps/closing_pass.h"
#include "densify/completeness/sight/survey_views.h"

namespace colmap_seapoint {

struct SurveySetting {
  double gsd = 0, spacing = 0;  // units
  // Where the survey's own resolution is asked for, and not a spacing of the user's: pixels a point
  // (JudgeOptions).
  double pixels_a_point = 0;
  double max_range = 0;  // units (MakeViews)
  PlanFrame frame;
};

struct JudgedSurvey {
  PassPlan plan;
  Ground ground;
  std::vector<LostRun> lost_runs;
  std::vector<PictureRecord> records;  // by image_idx
};

// `views`: of input.model. Reads the cloud once. Costs as AssessCompleteness.
JudgedSurvey JudgeSurvey(const CompletenessInput& input, const CompletenessOptions& options,
                         const SurveySetting& setting, const std::vector<SurveyView>& views,
                         int num_threads);

}  // namespace colmap_seapoint
