#include "densify/completeness/survey_scale.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr uint64_t kSampleSize = 20000;
constexpr size_t kScaleSample = 1000;

// Whether the track runs along the pictures' width.
bool RunsAlongWidth(const std::vector<SurveyView>& views) {
  double along_x = 0, along_y = 0;
  for (size_t i = 1; i < views.size(); ++i) {
    Eigen::Vector3d way = views[i].rotation * (views[i].center - views[i - 1].center);
    const double length = way.norm();
    if (!(length > 0)) continue;
    along_x += std::abs(way.x()) / length;
    along_y += std::abs(way.y()) / length;
  }
  return along_x > along_y;
}

}  // namespace

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

CloudSample SampleCloud(const CompletenessInput& input) {
  CloudSample sample;
  const uint64_t every = std::max<uint64_t>(1, input.num_points / kSampleSize);
  uint64_t index = 0;
  input.for_each_point([&](const ConfidentPoint& point) {
    if (index++ % every == 0) sample.points.push_back(point.place.xyz);
  });
  return sample;
}

SurveyScale MeasureScale(const std::vector<SurveyView>& views, const CloudSample& sample) {
  const size_t every = std::max<size_t>(1, sample.points.size() / kScaleSample);
  std::vector<double> gsds;
  size_t num_seen = 0, num_points = 0;
  for (size_t i = 0; i < sample.points.size(); i += every) {
    ++num_points;
    std::vector<double> of_point;
    for (const SurveyView& view : views) {
      if (view.Project(sample.points[i])) of_point.push_back(view.GsdAt(sample.points[i]));
    }
    if (of_point.empty()) continue;
    ++num_seen;
    std::sort(of_point.begin(), of_point.end());
    gsds.push_back(of_point[std::min<size_t>(1, of_point.size() - 1)]);
  }
  SurveyScale scale;
  scale.gsd = MedianOf(std::move(gsds));
  if (num_points > 0) {
    scale.seen_share = static_cast<double>(num_seen) / static_cast<double>(num_points);
  }
  return scale;
}

PassPlan PlanLikeSurvey(const std::vector<SurveyView>& views, const Ground& ground,
                        const CompletenessOptions& options) {
  const GroundLayer& top = ground.layers.begin()->second;
  std::vector<double> altitudes, widths, heights;
  for (const SurveyView& view : views) {
    const Eigen::Vector3d center = top.layer_from_world * view.center;
    const double altitude = std::abs(center.z() - top.surface.At(center.x(), center.y()).height);
    altitudes.push_back(altitude);
    widths.push_back(view.camera->width / view.camera->MeanFocal());
    heights.push_back(view.camera->height / view.camera->MeanFocal());
  }
  PassPlan plan;
  plan.altitude = MedianOf(std::move(altitudes));
  plan.across = plan.altitude * MedianOf(std::move(widths));
  plan.along = plan.altitude * MedianOf(std::move(heights));
  if (RunsAlongWidth(views)) std::swap(plan.across, plan.along);
  plan.forward_overlap = options.forward_overlap;
  plan.side_overlap = options.side_overlap;
  return plan;
}

std::vector<Eigen::Vector3d> CentersOf(const std::vector<SurveyView>& views) {
  std::vector<Eigen::Vector3d> centers;
  for (const SurveyView& view : views) centers.push_back(view.center);
  return centers;
}

std::vector<std::string> NamesOf(const SparseModel& model) {
  std::vector<std::string> names;
  for (const PosedImage& image : model.images) names.push_back(image.name);
  return names;
}

}  // namespace colmap_seapoint
