#include "tests/benchmark/hold_out.h"

#include <unordered_map>

#include "densify/densify_pair.h"
#include "tests/benchmark/cloud_measures.h"
#include "tests/benchmark/pair_measures.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinTrackLength = 3;
constexpr double kMaxError = 1;  // pixels
constexpr double kPassedGsd = 3, kNearGsd = 10;

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
    const int step = SampleStep(model.cameras.at(view.camera_id), densification);
    held.eligible.push_back(
        {point.xyz.cast<float>(), GsdOf(model, point, view), static_cast<double>(step)});
  }
  return held;
}

void ScoreHoldOut(const std::vector<HeldPoint>& eligible, const std::vector<Eigen::Vector3f>& cloud,
                  HoldOutRow* row) {
  row->eligible = static_cast<double>(eligible.size());
  if (eligible.empty()) return;
  const NearestPoint nearest(cloud);
  std::vector<double> near_distances;
  double num_passed = 0, num_passed_spacing = 0;
  for (const HeldPoint& point : eligible) {
    const double distance = nearest.Distance(point.xyz) / point.gsd;
    num_passed += distance <= kPassedGsd;
    num_passed_spacing += distance <= kPassedGsd * point.spacing;
    if (distance <= kNearGsd) near_distances.push_back(distance);
  }
  const double num_near = static_cast<double>(near_distances.size());
  row->near = num_near / row->eligible;
  row->passed = num_passed / row->eligible;
  row->passed_near = num_near > 0 ? num_passed / num_near : kNotMeasured;
  row->passed_spacing = num_passed_spacing / row->eligible;
  row->median_gsd = Median(near_distances);
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
