#include "colmap_seapoint/remeasuring/track_table.h"

#include <optional>
#include <unordered_map>

#include "feature/remeasuring/reference_patch.h"

namespace colmap_seapoint {
namespace {

struct View {
  size_t image_idx;
  Observation observation;
  Eigen::Vector3d ray;  // from the camera to the point, unit length
  double scale;         // pixels a unit of the surface
  double error;         // of reprojection, pixels
  bool holds_patch;
};

struct ImagePlace {
  size_t idx;
  size_t first_predicted;  // point2D_idx
};
using ImagePlaces = std::unordered_map<uint32_t, ImagePlace>;  // by image_id

bool HoldsPatchAt(const Camera& camera, const Eigen::Vector2d& pixel) {
  return camera.InImage(pixel) &&
         HoldsPatch(camera.width, camera.height, static_cast<int>(pixel.x()),
                    static_cast<int>(pixel.y()));
}

std::optional<View> ViewFrom(const SparseModel& model, const Eigen::Vector3d& xyz, size_t image_idx,
                             const Observation& observation) {
  const PosedImage& image = model.images[image_idx];
  if (observation.point2D_idx >= image.points2D.size()) return std::nullopt;
  const Eigen::Vector2d& pixel = image.points2D[observation.point2D_idx];
  const Eigen::Vector3d in_cam = image.cam_from_world * xyz;
  const Camera& camera = model.cameras.at(image.camera_id);
  const auto projected = camera.ImgFromCam(in_cam);
  if (!pixel.allFinite() || !projected) return std::nullopt;
  return View{image_idx,
              observation,
              image.cam_from_world.rotation.conjugate() * in_cam.normalized(),
              camera.MeanFocal() / in_cam.norm(),
              (*projected - pixel).norm(),
              HoldsPatchAt(camera, pixel)};
}

// The worse one of two in one picture is marked.
void MarkTwice(View* view, View* other) {
  if (view->image_idx != other->image_idx) return;
  View* worse = other->error < view->error ? view : other;
  worse->observation.role = ObservationRole::kTwice;
}

std::vector<View> ViewsOf(const SparseModel& model, const ImagePlaces& places, int point_idx,
                          const SparsePoint& point) {
  std::vector<View> views;
  for (const SparsePoint::TrackElement& element : point.track) {
    const auto place = places.find(element.image_id);
    if (place == places.end()) continue;
    const bool is_predicted = element.point2D_idx >= place->second.first_predicted;
    const auto view =
        ViewFrom(model, point.xyz, place->second.idx,
                 {point_idx, element.point2D_idx,
                  is_predicted ? ObservationRole::kPredicted : ObservationRole::kOther});
    if (view) views.push_back(*view);
  }
  for (size_t a = 0; a < views.size(); ++a) {
    for (size_t b = a + 1; b < views.size(); ++b) MarkTwice(&views[a], &views[b]);
  }
  return views;
}

void MarkReference(std::vector<View>* views) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const View& view : *views) mean += view.ray;
  mean.normalize();
  View* best = nullptr;
  double best_score = 0;
  for (View& view : *views) {
    if (view.observation.role != ObservationRole::kOther || !view.holds_patch) continue;
    const double score = view.scale * view.scale * view.ray.dot(mean);
    const bool is_first = best == nullptr || view.image_idx < best->image_idx;
    if (!(score > best_score || (score == best_score && is_first))) continue;
    best = &view;
    best_score = score;
  }
  if (best != nullptr) best->observation.role = ObservationRole::kReference;
}

}  // namespace

TrackTable MakeTrackTable(const SparseModel& model,
                          const std::map<uint32_t, size_t>& first_predicted) {
  ImagePlaces places;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const auto first = first_predicted.find(model.images[i].image_id);
    const size_t num_found =
        first == first_predicted.end() ? model.images[i].points2D.size() : first->second;
    places.emplace(model.images[i].image_id, ImagePlace{i, num_found});
  }
  TrackTable table;
  table.observations.resize(model.images.size());
  for (const auto& [id, point] : model.points3D) {
    const int point_idx = static_cast<int>(table.point3D_ids.size());
    table.point3D_ids.push_back(id);
    std::vector<View> views = ViewsOf(model, places, point_idx, point);
    MarkReference(&views);
    for (const View& view : views) table.observations[view.image_idx].push_back(view.observation);
  }
  return table;
}

}  // namespace colmap_seapoint
