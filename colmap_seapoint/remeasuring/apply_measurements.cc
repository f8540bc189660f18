#include "colmap_seapoint/remeasuring/apply_measurements.h"

#include <algorithm>
#include <unordered_map>

namespace colmap_seapoint {
namespace {

void Count(MeasurementOutcome outcome, RemeasuringCounts* counts) {
  switch (outcome) {
    case MeasurementOutcome::kUnmeasured:
      ++counts->unmeasured;
      break;
    case MeasurementOutcome::kReference:
      ++counts->references;
      break;
    case MeasurementOutcome::kMoved:
      ++counts->moved;
      break;
    case MeasurementOutcome::kUnlike:
      ++counts->unlike;
      break;
    case MeasurementOutcome::kDiverged:
      ++counts->diverged;
      break;
    case MeasurementOutcome::kUnsure:
      ++counts->unsure;
      break;
    case MeasurementOutcome::kElsewhere:
      ++counts->elsewhere;
      break;
    case MeasurementOutcome::kTwice:
      ++counts->twice;
      break;
    case MeasurementOutcome::kUnseen:
      ++counts->unseen;
      break;
  }
}

void ApplyToImage(const ImageMeasurements& measured, PosedImage* image, RemeasuringCounts* counts) {
  for (size_t i = 0; i < image->points2D.size(); ++i) {
    if (image->point3D_ids[i] == kNoPoint3D) continue;
    Count(measured[i].outcome, counts);
    if (measured[i].outcome == MeasurementOutcome::kMoved) image->points2D[i] = measured[i].pixel;
    if (IsTakenOut(measured[i].outcome)) image->point3D_ids[i] = kNoPoint3D;
  }
}

using ImagesById = std::unordered_map<uint32_t, PosedImage*>;

// Leaves what still names the point in its picture.
void ShortenTrack(const ImagesById& images, uint64_t id, SparsePoint* point) {
  const auto is_out = [&](const SparsePoint::TrackElement& element) {
    const auto image = images.find(element.image_id);
    return image == images.end() || element.point2D_idx >= image->second->point3D_ids.size() ||
           image->second->point3D_ids[element.point2D_idx] != id;
  };
  point->track.erase(std::remove_if(point->track.begin(), point->track.end(), is_out),
                     point->track.end());
}

}  // namespace

Remeasurement ApplyMeasurements(const SparseModel& model,
                                const std::vector<ImageMeasurements>& measured) {
  Remeasurement result;
  result.model = model;
  ImagesById images;
  for (size_t i = 0; i < measured.size(); ++i) {
    PosedImage& image = result.model.images[i];
    images[image.image_id] = &image;
    ApplyToImage(measured[i], &image, &result.counts);
  }
  auto& points = result.model.points3D;
  for (auto point = points.begin(); point != points.end();) {
    ShortenTrack(images, point->first, &point->second);
    if (point->second.track.size() >= 2) {
      ++point;
      continue;
    }
    for (const SparsePoint::TrackElement& element : point->second.track) {
      images[element.image_id]->point3D_ids[element.point2D_idx] = kNoPoint3D;
      ++result.counts.alone;
    }
    ++result.counts.removed_points;
    point = points.erase(point);
  }
  return result;
}

}  // namespace colmap_seapoint
