#include "densify/completeness/judge_survey.h"

#include "densify/completeness/judge_ground.h"
#include "densify/completeness/outline.h"
#include "densify/completeness/survey_limits.h"
#include "densify/completeness/survey_scale.h"

namespace colmap_seapoint {
namespace {

// Radius of the disc that closes the outline, in widths of a picture.
constexpr double kOutlineRadius = 0.75;

void CountPoints(const CompletenessInput& input, double min_confidence, Ground* ground) {
  input.for_each_point([&](const ConfidentPoint& point) {
    if (point.confidence >= min_confidence) AddPoint(point.place, ground);
  });
  for (const auto& [id, point] : input.model->points3D) AddHint(point.xyz, ground);
}

}  // namespace

JudgedSurvey JudgeSurvey(const CompletenessInput& input, const CompletenessOptions& options,
                         const SurveySetting& setting, const std::vector<SurveyView>& views,
                         int num_threads) {
  JudgedSurvey judged;
  Ground& ground = judged.ground;
  ground.frame = setting.frame;
  ground.cell_side = kCellSpacings * setting.spacing;
  CountPoints(input, options.min_confidence, &ground);
  FinishPoints(num_threads, &ground);

  judged.plan = PlanLikeSurvey(views, ground, options);
  const std::vector<DepthCells> depths = DrawDepths(ground, views, num_threads);
  judged.lost_runs = FindLostRuns(NamesOf(*input.model), input.lost, input.posed_elsewhere);
  const LostSight lost(judged.lost_runs, views, judged.plan.across);
  const SightContext context{&views, &depths,          &input.facts,
                             &lost,  ground.cell_side, options.min_parallax_deg};
  judged.records = StartRecords(context, num_threads);

  const AskedArea* asked = input.asked.Empty() ? nullptr : &input.asked;
  SpreadCells(views, &ground);
  JudgeGround(context, {setting.pixels_a_point, asked}, num_threads, &ground);
  LeaveOutBackground(setting.gsd, &ground);
  LeaveOutIslands(&ground);
  TellWhatLacksTexture(&ground);
  JudgeUnseen({kOutlineRadius * judged.plan.across, kFar * setting.gsd}, asked, lost, &ground);
  FillRecords(context, ground, num_threads, &judged.records);
  return judged;
}

}  // namespace colmap_seapoint
