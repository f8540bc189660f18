#include "colmap_seapoint/mapping/measure_again.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/remeasuring/extend_tracks.h"
#include "colmap_seapoint/remeasuring/remeasure_observations.h"
#include "feature/remeasuring/patch_matching.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kFirmObservations = 100;
constexpr size_t kMaxExtendedObservations = 1500;  // of a picture

size_t NumObservations(const PosedImage& image, size_t first_predicted) {
  const auto begin = image.point3D_ids.begin();
  return first_predicted -
         static_cast<size_t>(
             std::count(begin, begin + static_cast<std::ptrdiff_t>(first_predicted), kNoPoint3D));
}

// Whether each picture keeps half of its observations, predicted ones aside, or as many as hold it
// firmly.
bool HoldsFirmly(const SparseModel& before, const SparseModel& after,
                 const std::map<uint32_t, size_t>& first_predicted) {
  for (size_t i = 0; i < before.images.size(); ++i) {
    const size_t num_left =
        NumObservations(after.images[i], first_predicted.at(before.images[i].image_id));
    if (num_left < kFirmObservations &&
        2 * num_left <
            NumObservations(before.images[i], first_predicted.at(before.images[i].image_id))) {
      return false;
    }
  }
  return true;
}

// The model with its observations measured again in the pictures: those that are known best where
// they are enough, else those that are known at all; nullopt where neither are.
std::optional<SparseModel> MeasuredAgain(const SparseModel& model,
                                         const std::map<uint32_t, size_t>& first_predicted,
                                         const MeasuringJob& job) {
  RemeasuringOptions options;
  options.first_predicted = first_predicted;
  options.num_threads = job.num_threads;
  if (!job.mask_path.empty()) {
    options.read_mask = [&, masks = PictureMasks(job.mask_path)](const PosedImage& image) {
      const Camera& camera = model.cameras.at(image.camera_id);
      return masks.ReadForResampling(image.name, camera.width, camera.height);
    };
  }
  const auto read = [&](const PosedImage& image) {
    return ReadGrayImage(job.image_path / image.name);
  };
  for (const double max_sigma : {options.max_sigma, kMaxPatchSigma}) {
    options.max_sigma = max_sigma;
    Remeasurement measured = RemeasureObservations(options, model, read);
    if (HoldsFirmly(model, measured.model, first_predicted)) return std::move(measured.model);
  }
  return std::nullopt;
}

// How many observations a picture shall have when those that the model predicts are added.
size_t MaxObservations(size_t num_images) {
  return std::min(kMaxExtendedObservations,
                  kMaxAdjustedObservations / std::max<size_t>(1, num_images));
}

}  // namespace

void ExtendAndMeasure(const MeasuringJob& job, const std::map<uint32_t, size_t>& num_points2D,
                      SparseModel* model) {
  ExtendTracks({MaxObservations(model->images.size()), job.num_threads}, model);
  if (auto measured = MeasuredAgain(*model, num_points2D, job)) {
    *model = *std::move(measured);
  } else {
    DropExtensions(num_points2D, model);
  }
}

}  // namespace colmap_seapoint
