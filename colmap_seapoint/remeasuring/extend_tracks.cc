#include "colmap_seapoint/remeasuring/extend_tracks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "colmap_seapoint/base/parallel.h"
#include "feature/remeasuring/reference_patch.h"

namespace colmap_seapoint {
namespace {

constexpr int kMinSharedPoints = 10;  // of pictures that see the same things
constexpr size_t kMaxNeighbours = 40;
constexpr double kMinRangeRatio = 2.0 / 3;
const double kMinRayCosine = std::sqrt(0.5);

struct Prediction {
  uint32_t point_idx;
  Eigen::Vector2d pixel;
};

// Spreads neighbouring numbers evenly over all of them (Knuth's multiplicative hashing).
uint32_t Scattered(uint32_t value) { return value * 2654435761u; }

class TrackExtension {
 public:
  TrackExtension(const TrackExtensionOptions& options, const SparseModel& model)
      : options_(options), model_(model), points_of_(model.images.size()) {
    std::unordered_map<uint32_t, uint32_t> idxs;
    for (size_t i = 0; i < model.images.size(); ++i) {
      idxs.emplace(model.images[i].image_id, static_cast<uint32_t>(i));
      centres_.push_back(model.images[i].cam_from_world.Inverse().translation);
    }
    for (const auto& [id, point] : model.points3D) {
      const auto point_idx = static_cast<uint32_t>(ids_.size());
      ids_.push_back(id);
      points_.push_back(&point);
      track_begin_.push_back(track_.size());
      for (const SparsePoint::TrackElement& element : point.track) {
        const auto image = idxs.find(element.image_id);
        if (image == idxs.end()) continue;
        track_.push_back(image->second);
        points_of_[image->second].push_back(point_idx);
      }
    }
    track_begin_.push_back(track_.size());
  }

  // Of a picture, ascending by point.
  std::vector<Prediction> Predict(size_t image_idx) const {
    const size_t num_observed = points_of_[image_idx].size();
    if (num_observed >= options_.max_observations) return {};
    std::vector<Prediction> predictions;
    for (const uint32_t point_idx : CandidatesOf(image_idx)) {
      if (const auto pixel = Project(image_idx, point_idx)) {
        predictions.push_back({point_idx, *pixel});
      }
    }
    Thin(options_.max_observations - num_observed, &predictions);
    return predictions;
  }

  uint64_t IdOf(uint32_t point_idx) const { return ids_[point_idx]; }

 private:
  // The pictures that share most points, the most first.
  std::vector<uint32_t> NeighboursOf(size_t image_idx) const {
    std::unordered_map<uint32_t, int> num_shared;
    for (const uint32_t point_idx : points_of_[image_idx]) {
      for (size_t k = track_begin_[point_idx]; k < track_begin_[point_idx + 1]; ++k) {
        ++num_shared[track_[k]];
      }
    }
    num_shared.erase(static_cast<uint32_t>(image_idx));
    std::vector<std::pair<int, uint32_t>> ranked;
    for (const auto& [neighbour, num] : num_shared) {
      if (num >= kMinSharedPoints) ranked.push_back({-num, neighbour});
    }
    std::sort(ranked.begin(), ranked.end());
    ranked.resize(std::min(ranked.size(), kMaxNeighbours));
    std::vector<uint32_t> neighbours;
    for (const auto& [num, neighbour] : ranked) neighbours.push_back(neighbour);
    return neighbours;
  }

  // Points that neighbours observe and the picture does not, ascending.
  std::vector<uint32_t> CandidatesOf(size_t image_idx) const {
    std::vector<uint32_t> seen_near;
    for (const uint32_t neighbour : NeighboursOf(image_idx)) {
      const std::vector<uint32_t>& points = points_of_[neighbour];
      seen_near.insert(seen_near.end(), points.begin(), points.end());
    }
    std::sort(seen_near.begin(), seen_near.end());
    seen_near.erase(std::unique(seen_near.begin(), seen_near.end()), seen_near.end());
    std::vector<uint32_t> candidates;
    std::set_difference(seen_near.begin(), seen_near.end(), points_of_[image_idx].begin(),
                        points_of_[image_idx].end(), std::back_inserter(candidates));
    return candidates;
  }

  // Where the picture shows the point; nullopt where it does not, or hardly alike.
  std::optional<Eigen::Vector2d> Project(size_t image_idx, uint32_t point_idx) const {
    const PosedImage& image = model_.images[image_idx];
    const Camera& camera = model_.cameras.at(image.camera_id);
    const Eigen::Vector3d& xyz = points_[point_idx]->xyz;
    const auto pixel = camera.ImgFromCam(image.cam_from_world * xyz);
    if (!pixel || !camera.InImage(*pixel) ||
        !HoldsPatch(camera.width, camera.height, static_cast<int>(pixel->x()),
                    static_cast<int>(pixel->y()))) {
      return std::nullopt;
    }
    return LooksAlike(centres_[image_idx] - xyz, point_idx) ? pixel : std::nullopt;
  }

  bool LooksAlike(const Eigen::Vector3d& ray, uint32_t point_idx) const {
    const double range = ray.norm();
    double least_range = std::numeric_limits<double>::infinity(), best_cosine = -1;
    for (size_t k = track_begin_[point_idx]; k < track_begin_[point_idx + 1]; ++k) {
      const Eigen::Vector3d other = centres_[track_[k]] - points_[point_idx]->xyz;
      least_range = std::min(least_range, other.norm());
      best_cosine = std::max(best_cosine, ray.dot(other) / (range * other.norm()));
    }
    return range >= kMinRangeRatio * least_range && best_cosine >= kMinRayCosine;
  }

  static void Thin(size_t num_kept, std::vector<Prediction>* predictions) {
    if (predictions->size() <= num_kept) return;
    const auto is_before = [](const Prediction& a, const Prediction& b) {
      return Scattered(a.point_idx) < Scattered(b.point_idx);
    };
    std::nth_element(predictions->begin(),
                     predictions->begin() + static_cast<std::ptrdiff_t>(num_kept),
                     predictions->end(), is_before);
    predictions->resize(num_kept);
    std::sort(predictions->begin(), predictions->end(),
              [](const Prediction& a, const Prediction& b) { return a.point_idx < b.point_idx; });
  }

  const TrackExtensionOptions& options_;
  const SparseModel& model_;
  std::vector<Eigen::Vector3d> centres_;          // by image_idx
  std::vector<std::vector<uint32_t>> points_of_;  // by image_idx, ascending
  std::vector<uint64_t> ids_;                     // by point_idx
  std::vector<const SparsePoint*> points_;        // by point_idx
  std::vector<size_t> track_begin_;               // by point_idx, and the end: in track_
  std::vector<uint32_t> track_;                   // image_idxs
};

}  // namespace

std::map<uint32_t, size_t> NumPoints2D(const SparseModel& model) {
  std::map<uint32_t, size_t> nums;
  for (const PosedImage& image : model.images) nums[image.image_id] = image.points2D.size();
  return nums;
}

void ExtendTracks(const TrackExtensionOptions& options, SparseModel* model) {
  const TrackExtension extension(options, *model);
  std::vector<std::vector<Prediction>> predictions(model->images.size());
  ParallelFor(options.num_threads, static_cast<int64_t>(model->images.size()), [&](int64_t i) {
    predictions[static_cast<size_t>(i)] = extension.Predict(static_cast<size_t>(i));
  });
  for (size_t i = 0; i < model->images.size(); ++i) {
    PosedImage& image = model->images[i];
    for (const Prediction& prediction : predictions[i]) {
      const uint64_t id = extension.IdOf(prediction.point_idx);
      model->points3D.at(id).track.push_back(
          {image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.push_back(prediction.pixel);
      image.point3D_ids.push_back(id);
    }
  }
}

void DropExtensions(const std::map<uint32_t, size_t>& num_points2D, SparseModel* model) {
  std::unordered_map<uint32_t, PosedImage*> images;
  for (PosedImage& image : model->images) {
    images[image.image_id] = &image;
    image.points2D.resize(num_points2D.at(image.image_id));
    image.point3D_ids.resize(image.points2D.size());
  }
  const auto is_extension = [&](const SparsePoint::TrackElement& element) {
    return element.point2D_idx >= images.at(element.image_id)->points2D.size();
  };
  auto& points = model->points3D;
  for (auto point = points.begin(); point != points.end();) {
    std::vector<SparsePoint::TrackElement>& track = point->second.track;
    track.erase(std::remove_if(track.begin(), track.end(), is_extension), track.end());
    if (track.size() >= 2) {
      ++point;
      continue;
    }
    for (const SparsePoint::TrackElement& element : track) {
      images.at(element.image_id)->point3D_ids[element.point2D_idx] = kNoPoint3D;
    }
    point = points.erase(point);
  }
}

}  // namespace colmap_seapoint
