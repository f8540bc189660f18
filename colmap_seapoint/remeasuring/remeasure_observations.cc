#include "colmap_seapoint/remeasuring/remeasure_observations.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/picture.h"
#include "colmap_seapoint/remeasuring/apply_measurements.h"
#include "colmap_seapoint/remeasuring/surface_patch.h"
#include "colmap_seapoint/remeasuring/surface_planes.h"
#include "colmap_seapoint/remeasuring/track_table.h"

namespace colmap_seapoint {
namespace {

// What is kept of a point's best picture.
struct KeptPatch {
  SurfacePatch surface;
  ReferencePatch gray;
  Eigen::Vector2f aside;  // from the middle of the patch to the point, pixels
};
static_assert(sizeof(std::optional<KeptPatch>) <= 400, "one a point of the whole survey");

// Whether a mask (empty: none) hides any of a patch, laid around a pixel by a warp.
bool HidesPatch(const GrayImage& mask, const Eigen::Vector2d& pixel, const Eigen::Matrix2d& warp) {
  if (mask.Empty()) return false;
  const Eigen::Array2d reach = ReferencePatch::kReach * warp.cwiseAbs().rowwise().sum().array();
  const Eigen::Array2d last(mask.width - 1, mask.height - 1);
  const Eigen::Array2d first = pixel.array() - reach, end = pixel.array() + reach;
  if (!(first <= last).all() || !(end >= 0).all()) return false;  // not in the picture, or NaN
  const Eigen::Array2i low = first.max(0).cast<int>(), high = end.min(last).cast<int>();
  for (int y = low.y(); y <= high.y(); ++y) {
    for (int x = low.x(); x <= high.x(); ++x) {
      if (mask.At(x, y) == 0) return true;
    }
  }
  return false;
}

class Remeasuring {
 public:
  Remeasuring(const RemeasuringOptions& options, const SparseModel& model,
              const GrayPictureReader& read)
      : options_(options),
        model_(model),
        read_(read),
        tracks_(MakeTrackTable(model, options.first_predicted)),
        patches_(tracks_.point3D_ids.size()),
        is_of_other_size_(model.images.size(), 0) {}

  Remeasurement Run() {
    const auto num_images = static_cast<int64_t>(model_.images.size());
    ParallelFor(options_.num_threads, num_images, [&](int64_t i) { KeepPatches(i); });
    std::vector<ImageMeasurements> measured(model_.images.size());
    ParallelFor(options_.num_threads, num_images,
                [&](int64_t i) { measured[static_cast<size_t>(i)] = MeasureImage(i); });
    Remeasurement result = ApplyMeasurements(model_, measured);
    for (size_t i = 0; i < model_.images.size(); ++i) {
      if (is_of_other_size_[i]) result.of_other_size.push_back(model_.images[i].name);
    }
    return result;
  }

 private:
  // Empty when the picture has not its camera's size.
  Picture Read(size_t image_idx) {
    const PosedImage& image = model_.images[image_idx];
    const Camera& camera = model_.cameras.at(image.camera_id);
    Picture picture;
    picture.luma = read_(image);
    if (options_.read_mask) picture.mask = options_.read_mask(image);
    if (picture.luma.width == camera.width && picture.luma.height == camera.height) return picture;
    is_of_other_size_[image_idx] = 1;
    return {};
  }

  std::vector<SeenPlane> PlanesOf(size_t image_idx) const {
    std::vector<SeenPoint> points;
    std::vector<size_t> wanted;
    for (const Observation& observation : tracks_.observations[image_idx]) {
      const uint64_t id = tracks_.point3D_ids[static_cast<size_t>(observation.point_idx)];
      const Eigen::Vector3d in_cam =
          model_.images[image_idx].cam_from_world * model_.points3D.at(id).xyz;
      if (observation.role == ObservationRole::kReference) wanted.push_back(points.size());
      points.push_back({in_cam.hnormalized(), 1 / in_cam.z()});
    }
    return FitPlanes(points, wanted);
  }

  // Of the points that this picture shows best.
  void KeepPatches(int64_t i) {
    const auto image_idx = static_cast<size_t>(i);
    const std::vector<SeenPlane> planes = PlanesOf(image_idx);
    if (planes.empty()) return;
    const Picture picture = Read(image_idx);
    if (picture.Empty()) return;
    auto plane = planes.begin();
    for (const Observation& observation : tracks_.observations[image_idx]) {
      if (observation.role != ObservationRole::kReference) continue;
      patches_[static_cast<size_t>(observation.point_idx)] =
          MakePatch(model_.images[image_idx], observation, *plane++, picture);
    }
  }

  std::optional<KeptPatch> MakePatch(const PosedImage& image, const Observation& observation,
                                     const SeenPlane& plane, const Picture& picture) const {
    const Eigen::Vector2d& pixel = image.points2D[observation.point2D_idx];
    const Eigen::Vector2d middle = pixel.array().floor() + 0.5;
    const auto surface =
        PatchOnPlane(model_.cameras.at(image.camera_id), image.cam_from_world, plane, middle);
    const auto gray =
        CutPatch(picture.luma, static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
    if (!surface || !gray) return std::nullopt;
    if (HidesPatch(picture.mask, middle, Eigen::Matrix2d::Identity())) return std::nullopt;
    return KeptPatch{*surface, *gray, (pixel - middle).cast<float>()};
  }

  bool IsToBeMeasured(const Observation& observation) const {
    return (observation.role == ObservationRole::kOther ||
            observation.role == ObservationRole::kPredicted) &&
           patches_[static_cast<size_t>(observation.point_idx)].has_value();
  }

  ImageMeasurements MeasureImage(int64_t i) {
    const auto image_idx = static_cast<size_t>(i);
    const PosedImage& image = model_.images[image_idx];
    const std::vector<Observation>& observations = tracks_.observations[image_idx];
    const bool is_needed =
        !is_of_other_size_[image_idx] &&
        std::any_of(observations.begin(), observations.end(),
                    [&](const Observation& observation) { return IsToBeMeasured(observation); });
    const Picture picture = is_needed ? Read(image_idx) : Picture();
    ImageMeasurements measured(image.points2D.size());
    for (const Observation& observation : observations) {
      Measurement& measurement = measured[observation.point2D_idx];
      if (observation.role == ObservationRole::kReference) {
        measurement.outcome = MeasurementOutcome::kReference;
      } else if (observation.role == ObservationRole::kTwice) {
        measurement.outcome = MeasurementOutcome::kTwice;
      } else if (!picture.Empty() && IsToBeMeasured(observation)) {
        measurement = Measure(image, observation, picture);
      }
      if (observation.role == ObservationRole::kPredicted &&
          measurement.outcome == MeasurementOutcome::kUnmeasured) {
        measurement.outcome = MeasurementOutcome::kUnseen;
      }
    }
    return measured;
  }

  Measurement Measure(const PosedImage& image, const Observation& observation,
                      const Picture& picture) const {
    const KeptPatch& patch = *patches_[static_cast<size_t>(observation.point_idx)];
    const auto predicted =
        PredictPatch(model_.cameras.at(image.camera_id), image.cam_from_world, patch.surface);
    if (!predicted) return {};
    const PredictedPlace& place = predicted->place;
    if (HidesPatch(picture.mask, place.pixel, place.other_from_reference)) return {};
    const PatchMatch match = MatchPatch(patch.gray, picture.luma, place);
    Measurement measurement;
    measurement.outcome = OutcomeOf(match.status);
    if (measurement.outcome != MeasurementOutcome::kMoved) return measurement;
    measurement.pixel =
        match.pixel - predicted->bend + place.other_from_reference * patch.aside.cast<double>();
    const double move = (measurement.pixel - image.points2D[observation.point2D_idx]).norm();
    if (!(match.sigma <= options_.max_sigma)) measurement.outcome = MeasurementOutcome::kUnsure;
    const double max_move = observation.role == ObservationRole::kPredicted
                                ? options_.max_predicted_move
                                : options_.max_move;
    if (!(move <= max_move)) measurement.outcome = MeasurementOutcome::kElsewhere;
    return measurement;
  }

  static MeasurementOutcome OutcomeOf(PatchMatchStatus status) {
    switch (status) {
      case PatchMatchStatus::kMatched:
        return MeasurementOutcome::kMoved;
      case PatchMatchStatus::kUnlike:
        return MeasurementOutcome::kUnlike;
      case PatchMatchStatus::kDiverged:
        return MeasurementOutcome::kDiverged;
      case PatchMatchStatus::kNoTexture:
      case PatchMatchStatus::kUnsure:
        return MeasurementOutcome::kUnsure;
      case PatchMatchStatus::kOutside:
        break;
    }
    return MeasurementOutcome::kUnmeasured;
  }

  const RemeasuringOptions& options_;
  const SparseModel& model_;
  const GrayPictureReader& read_;
  TrackTable tracks_;
  std::vector<std::optional<KeptPatch>> patches_;  // by point_idx
  std::vector<uint8_t> is_of_other_size_;          // by image_idx
};

}  // namespace

Remeasurement RemeasureObservations(const RemeasuringOptions& options, const SparseModel& model,
                                    const GrayPictureReader& read) {
  return Remeasuring(options, model, read).Run();
}

}  // namespace colmap_seapoint
