// How large a survey is: its sampling distance, its altitude, what a picture shows.
#pragma once

#include <string>
#include <vector>

#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// An even sample of the cloud, up to some ten thousand points.
struct CloudSample {
  std::vector<Eigen::Vector3d> points;  // world
};
CloudSample SampleCloud(const CompletenessInput& input);

struct SurveyScale {
  double gsd = 0;         // units a pixel: median over the sample of the second nearest picture's
  double seen_share = 0;  // of the sample: in one picture at least
};
SurveyScale MeasureScale(const std::vector<SurveyView>& views, const CloudSample& sample);

// Altitude and size of a picture on the ground as the survey's median picture has them.
PassPlan PlanLikeSurvey(const std::vector<SurveyView>& views, const Ground& ground,
                        const CompletenessOptions& options);

std::vector<Eigen::Vector3d> CentersOf(const std::vector<SurveyView>& views);
std::vector<std::string> NamesOf(const SparseModel& model);
// 0 for none.
double MedianOf(std::vector<double> values);

}  // namespace colmap_seapoint
