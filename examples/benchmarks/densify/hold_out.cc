#include "examples/benchmarks/densify/hold_out.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "densify/densify_pair.h"
#include "examples/benchmarks/densify/cloud_measures.h"
#include "examples/benchmarks/feature/pair_measures.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinTrackLength = 3;
constexpr double kMaxError = 1;  // pixels
constexpr double kPassedGsd = 3, kNearGsd = 10, kSureGsd = 1;
constexpr double kMaxOwnGsd = 1e6;  // without parallax nothing is known
constexpr double kHalfPi = 1.57079632679489661923;

std::unordered_map<uint32_t, size_t> PositionById(const SparseModel& model) {
  std::unordered_map<uint32_t, size_t> position;
  for (size_t i = 0; i < model.images.size(); ++i) position[model.images[i].image_id] = i;
  return position;
}

const PosedImage& FirstView(const SparseModel& model, const SparsePoint& point,
                            const std::unordered_map<uint32_t, size_t>& position) {
  return model.images[position.at(point.track.front().image_id)];
}

double GsdOf(const SparseModel& model, const SparsePoint& point, const PosedImage& view) {
  return (view.cam_from_world * point.xyz).z() / model.cameras.at(view.camera_id).MeanFocal();
}

// Largest angle between the rays of two views, radians.
double LargestParallax(const SparseModel& model, const SparsePoint& point,
                       const std::unordered_map<uint32_t, size_t>& position) {
  std::vector<Eigen::Vector3d> rays;
  for (const SparsePoint::TrackElement& element : point.track) {
    const Rigid3d& pose = model.images[position.at(element.image_id)].cam_from_world;
    rays.push_back((pose.OriginInSource() - point.xyz).normalized());
  }
  double smallest_cosine = 1;
  for (size_t i = 0; i < rays.size(); ++i) {
    for (size_t k = 0; k < i; ++k)
      smallest_cosine = std::min(smallest_cosine, rays[i].dot(rays[k]));
  }
  return std::acos(std::max(-1.0, smallest_cosine));
}

}  // namespace

HoldOut HoldOutPoints(const SparseModel& model, int every,
                      const PartialDensificationOptions& densification) {
  HoldOut held;
  held.model = model;
  const auto position = PositionById(model);
  int count = 0;
  for (const auto& [id, point] : model.points3D) {
    if (point.track.empty() || ++count % every != 0) continue;
    held.model.points3D.erase(id);
    ++held.num_held;
    for (const SparsePoint::TrackElement& element : point.track) {
      const size_t i = position.at(element.image_id);
      held.model.images[i].point3D_ids.at(element.point2D_idx) = kNoPoint3D;
      held.places[static_cast<int>(i)].push_back(model.images[i].points2D.at(element.point2D_idx));
    }
    if (point.track.size() < kMinTrackLength || point.error > kMaxError) continue;
    const PosedImage& view = FirstView(model, point, position);
    const int step = SampleStep(model.cameras.at(view.camera_id), densification.step);
    const double parallax = std::min(LargestParallax(model, point, position), kHalfPi);
    held.eligible.push_back({point.xyz.cast<float>(), GsdOf(model, point, view),
                             static_cast<double>(step),
                             std::min(point.error / std::tan(parallax), kMaxOwnGsd)});
  }
  return held;
}

void ScoreHoldOut(const std::vector<HeldPoint>& eligible, const std::vector<Eigen::Vector3f>& cloud,
                  HoldOutRow* row) {
  row->eligible = static_cast<double>(eligible.size());
  if (eligible.empty()) return;
  const NearestPoint nearest(cloud);
  std::vector<double> near_distances;
  std::vector<double> own;
  double num_passed = 0, num_passed_spacing = 0, num_sure = 0, num_passed_sure = 0;
  for (const HeldPoint& point : eligible) {
    const double distance = nearest.Distance(point.xyz) / point.gsd;
    num_passed += distance <= kPassedGsd;
    num_passed_spacing += distance <= kPassedGsd * point.spacing;
    if (distance <= kNearGsd) near_distances.push_back(distance);
    own.push_back(point.own_gsd);
    num_sure += point.own_gsd <= kSureGsd;
    num_passed_sure += point.own_gsd <= kSureGsd && distance <= kPassedGsd;
  }
  const double num_near = static_cast<double>(near_distances.size());
  row->near = num_near / row->eligible;
  row->passed = num_passed / row->eligible;
  row->passed_near = num_near > 0 ? num_passed / num_near : kNotMeasured;
  row->passed_spacing = num_passed_spacing / row->eligible;
  row->median_gsd = Median(near_distances);
  row->own_gsd = Median(own);
  row->passed_sure = num_sure > 0 ? num_passed_sure / num_sure : kNotMeasured;
}

double MedianGsd(const SparseModel& model) {
  const auto position = PositionById(model);
  std::vector<double> values;
  for (const auto& [id, point] : model.points3D) {
    if (!point.track.empty()) {
      values.push_back(GsdOf(model, point, FirstView(model, point, position)));
    }
  }
  return values.empty() ? 0 : Median(values);
}

}  // namespace colmap_seapoint
