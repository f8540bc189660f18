#include "densify/completeness/survey_scale.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr uint64_t kSampleSize = 20000;
constexpr size_t kScaleSample = 1000;
constexpr double kMinCosine = 0.17;  // of the angle to the normal: 80 degrees

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

// Of a point of the cloud: nothing hides it.
std::vector<Sight> SightsOfPoint(const std::vector<SurveyView>& views, const SurfacePoint& point) {
  std::vector<Sight> sights;
  for (const SurveyView& view : views) {
    if (!view.Project(point.xyz)) continue;
    const Eigen::Vector3d to_camera = view.center - point.xyz;
    // A normal that is not known looks at the camera.
    const double length = to_camera.norm() * point.normal.norm();
    const double cosine = length > 0 ? std::abs(point.normal.dot(to_camera)) / length : 1;
    Sight sight;
    sight.gsd = view.GsdAt(point.xyz) / std::sqrt(std::max(cosine, kMinCosine));
    sight.toward = to_camera.normalized();
    sights.push_back(sight);
  }
  return sights;
}

}  // namespace

double MedianOf(std::vector<double> values) {
  return values.empty() ? 0 : UpperMedian(std::move(values));
}

std::vector<SurfacePoint> SampleCloud(const CompletenessInput& input) {
  std::vector<SurfacePoint> sample;
  const uint64_t every = std::max<uint64_t>(1, input.num_points / kSampleSize);
  uint64_t index = 0;
  input.for_each_point([&](const ConfidentPoint& point) {
    if (index++ % every == 0) sample.push_back(point.place);
  });
  return sample;
}

std::vector<Eigen::Vector3d> PlacesOf(const std::vector<SurfacePoint>& points) {
  std::vector<Eigen::Vector3d> places;
  for (const SurfacePoint& point : points) places.push_back(point.xyz);
  return places;
}

SurveyScale MeasureScale(const std::vector<SurveyView>& views,
                         const std::vector<SurfacePoint>& sample, double min_parallax_deg) {
  const size_t every = std::max<size_t>(1, sample.size() / kScaleSample);
  std::vector<double> pairs, nearest;
  size_t num_points = 0;
  for (size_t i = 0; i < sample.size(); i += every) {
    ++num_points;
    const std::vector<Sight> sights = SightsOfPoint(views, sample[i]);
    if (sights.empty()) continue;
    nearest.push_back(NearestGsd(sights));
    if (const auto gsd = PairGsd(sights, min_parallax_deg)) pairs.push_back(*gsd);
  }
  SurveyScale scale;
  if (num_points > 0) {
    scale.seen_share = static_cast<double>(nearest.size()) / static_cast<double>(num_points);
  }
  scale.gsd = MedianOf(pairs.empty() ? std::move(nearest) : std::move(pairs));
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

std::vector<std::string> NamesOf(const SparseModel& model) {
  std::vector<std::string> names;
  for (const PosedImage& image : model.images) names.push_back(image.name);
  return names;
}

}  // namespace colmap_seapoint
