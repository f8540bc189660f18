#include "colmap_seapoint/lens/held_out_tracks.h"

#include <algorithm>

#include "colmap_seapoint/adjustment/equations/bundle.h"
#include "colmap_seapoint/adjustment/equations/linearization.h"
#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

// Two pictures say nothing of a track along the line on which one's place lies for the other.
constexpr size_t kMinViews = 3;

// First on a loss that finds its way, since bent poses may put a point off by more than the last
// loss can see; then on that.
constexpr double kWaySigmas = 3;
constexpr int kStepsOfEach = 4;

size_t NumObservations(const SparseModel& model, const std::vector<uint64_t>& ids) {
  size_t count = 0;
  for (const uint64_t id : ids) count += model.points3D.at(id).track.size();
  return count;
}

// Every so-manyth, so that they hold no more observations than `max`.
std::vector<uint64_t> Evenly(const SparseModel& model, const std::vector<uint64_t>& ids,
                             size_t max) {
  const size_t step = std::max<size_t>(1, (NumObservations(model, ids) + max - 1) / max);
  std::vector<uint64_t> chosen;
  for (size_t k = 0; k < ids.size(); k += step) chosen.push_back(ids[k]);
  return chosen;
}

SparseModel WithTracks(const SparseModel& model, const std::vector<uint64_t>& ids) {
  SparseModel part;
  part.cameras = model.cameras;
  for (const uint64_t id : ids) part.points3D.emplace_hint(part.points3D.end(), id, SparsePoint());
  for (const PosedImage& image : model.images) {
    PosedImage& copy = part.images.emplace_back();
    copy.image_id = image.image_id;
    copy.camera_id = image.camera_id;
    copy.name = image.name;
    copy.cam_from_world = image.cam_from_world;
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      const auto point = part.points3D.find(image.point3D_ids[k]);
      if (point == part.points3D.end()) continue;
      point->second.track.push_back({image.image_id, static_cast<uint32_t>(copy.points2D.size())});
      copy.points2D.push_back(image.points2D[k]);
      copy.point3D_ids.push_back(point->first);
    }
  }
  for (auto& [id, point] : part.points3D) point.xyz = model.points3D.at(id).xyz;
  return part;
}

}  // namespace

SplitTracks Split(const TrackSplit& split, const SparseModel& model) {
  std::vector<uint64_t> fitted, held_out;
  size_t count = 0;
  for (const auto& [id, point] : model.points3D) {
    if (point.track.size() < kMinViews) continue;
    (++count % split.held_out_every == 0 ? held_out : fitted).push_back(id);
  }
  return {WithTracks(model, Evenly(model, fitted, split.max_fitted_observations)),
          WithTracks(model, Evenly(model, held_out, split.max_held_out_observations))};
}

std::vector<double> HeldOutCosts(const SparseModel& held_out, const SparseModel& adjusted,
                                 const RobustLoss& loss, int num_threads) {
  SEAPOINT_CHECK(held_out.images.size() == adjusted.images.size());
  // Which observations take part must not depend on the cameras that are judged.
  const Bundle bundle = MakeBundle(held_out, {});
  BundleValues values = ReadValues(bundle, {}, held_out);
  Bundle judged = bundle;
  for (size_t c = 0; c < judged.lenses.size(); ++c) {
    const Camera& camera = adjusted.cameras.at(judged.camera_id[c]);
    judged.lenses[c].model = camera.model;
    values.lenses[c].fill(0);
    std::copy(camera.params.begin(), camera.params.end(), values.lenses[c].begin());
  }
  for (size_t i = 0; i < judged.NumPictures(); ++i) {
    const Rigid3d& pose = adjusted.images[judged.image_idx[i]].cam_from_world;
    values.poses[i] = {pose.rotation.normalized().toRotationMatrix(), pose.translation};
  }
  const RobustLoss way = {LossKind::kSoftLOne, kWaySigmas * loss.scale};
  std::vector<double> costs(judged.NumPoints());
  ParallelFor(num_threads, static_cast<int64_t>(costs.size()), [&](int64_t point) {
    const auto p = static_cast<size_t>(point);
    PlacedPoint placed = PlacePoint(judged, values, way, p, values.points[p]);
    placed = RefinePoint(judged, values, way, p, kStepsOfEach, placed);
    placed = PlacePoint(judged, values, loss, p, placed.xyz);
    costs[p] = RefinePoint(judged, values, loss, p, kStepsOfEach, placed).cost;
  });
  return costs;
}

}  // namespace colmap_seapoint
