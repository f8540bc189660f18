// How large a survey is: its sampling distance, its altitude, what a picture shows.
#pragma once

#include <string>
#include <vector>

#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// An even sample of the cloud, up to some ten thousand points.
std::vector<SurfacePoint> SampleCloud(const CompletenessInput& input);
std::vector<Eigen::Vector3d> PlacesOf(const std::vector<SurfacePoint>& points);

struct SurveyScale {
  // Units a pixel on the surface: median over the sample of what the two pictures that measure a
  // point best have (PairGsd); without such two, of the nearest picture's.
  double gsd = 0;
  double seen_share = 0;  // of the sample: in one picture at least
};
SurveyScale MeasureScale(const std::vector<SurveyView>& views,
                         const std::vector<SurfacePoint>& sample, double min_parallax_deg);

// Altitude and size of a picture on the ground as the survey's median picture has them.
PassPlan PlanLikeSurvey(const std::vector<SurveyView>& views, const Ground& ground,
                        const CompletenessOptions& options);

std::vector<std::string> NamesOf(const SparseModel& model);
// 0 for none.
double MedianOf(std::vector<double> values);

}  // namespace colmap_seapoint
