#include "colmap_seapoint/adjustment/bundle_adjustment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/adjustment/bundle_minimizer.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {
namespace {

// Pixels. However well most observations are measured, the last loss is not made narrower than for
// such errors: those of the others still count.
constexpr double kMinResidualSigma = 0.05;

std::map<uint32_t, LensFreedom> FreedomOfLenses(const BundleAdjustmentOptions& options,
                                                const SparseModel& model) {
  std::map<uint32_t, LensFreedom> freedom = options.lenses;
  for (const auto& [id, camera] : model.cameras) {
    const auto principal = static_cast<uint32_t>(NumFocals(camera.model));
    LensFreedom& of_camera = freedom[id];
    if (!options.refine_principal_point) of_camera.held_params |= 3u << principal;
    of_camera.principal_point_sigma =
        options.principal_point_sigma * std::max(camera.width, camera.height);
  }
  return freedom;
}

// Of one coordinate, pixels, as the median of all errors has it where they are normally
// distributed.
double ResidualSigma(const Bundle& bundle, const BundleValues& values) {
  constexpr double kMedianOfUnit = 1.17741;  // of the length of a vector with two such coordinates
  std::vector<double> errors;
  errors.reserve(bundle.NumObservations());
  for (size_t k = 0; k < bundle.NumObservations(); ++k) {
    const uint32_t picture = bundle.picture_of[k];
    const uint32_t lens = bundle.lens_of_picture[picture];
    const Eigen::Vector2d pixel =
        ProjectThroughLens(bundle.lenses[lens].model, values.lenses[lens],
                           values.poses[picture] * values.points[bundle.point_of[k]]);
    const double error = (pixel - bundle.pixels[k]).norm();
    if (std::isfinite(error)) errors.push_back(error);
  }
  return errors.empty() ? 0 : UpperMedian(std::move(errors)) / kMedianOfUnit;
}

int64_t NumFreePictures(const Bundle& bundle) {
  return std::count(bundle.holds_pose.begin(), bundle.holds_pose.end(), false);
}

// How much larger errors are than what an adjustment leaves of them, since it fits so many values.
double ErrorsToResiduals(const Bundle& bundle) {
  double num_free = 3.0 * static_cast<double>(bundle.NumPoints()) +
                    6.0 * static_cast<double>(NumFreePictures(bundle)) - 7;
  for (const BundleLens& lens : bundle.lenses) num_free += lens.num_free;
  const double num_residuals = 2.0 * static_cast<double>(bundle.NumObservations());
  return num_residuals > num_free ? std::sqrt(num_residuals / (num_residuals - num_free)) : 1;
}

// As many as each lens has, by camera id.
std::map<uint32_t, std::vector<double>> ById(const Bundle& bundle,
                                             const std::vector<LensParams>& of_lenses) {
  std::map<uint32_t, std::vector<double>> by_id;
  for (size_t c = 0; c < bundle.lenses.size(); ++c) {
    const int count = FindCameraModel(static_cast<int>(bundle.lenses[c].model))->num_params;
    by_id[bundle.camera_id[c]].assign(of_lenses[c].begin(), of_lenses[c].begin() + count);
  }
  return by_id;
}

void AddSpreads(const BundleAdjustmentOptions& options, const Bundle& bundle,
                const BundleMinimizer& minimizer, const BundleValues& values,
                BundleAdjustment* adjustment) {
  std::vector<LensParams> sigmas;
  for (size_t c = 0; c < bundle.lenses.size(); ++c) {
    sigmas.push_back(minimizer.LensSigmas(c, adjustment->error_sigma));
  }
  adjustment->lens_sigmas = ById(bundle, sigmas);
  if (options.centre_weights.empty()) return;
  std::vector<Eigen::Vector3d> weights;
  for (uint32_t image : bundle.image_idx) weights.push_back(options.centre_weights.at(image));
  const LinearSpread spread = minimizer.SpreadOfCentres(weights, values, adjustment->error_sigma);
  adjustment->centre_sigma = spread.sigma;
  adjustment->centre_correlations = ById(bundle, spread.correlations);
}

// Points that only one picture sees are put on its ray again, as far from it as they were.
void CarryLonePoints(const SparseModel& before, const std::vector<uint64_t>& adjusted_ids,
                     SparseModel* after) {
  for (size_t i = 0; i < after->images.size(); ++i) {
    const PosedImage& image = after->images[i];
    const auto camera = after->cameras.find(image.camera_id);
    if (camera == after->cameras.end()) continue;
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      const auto point = after->points3D.find(image.point3D_ids[k]);
      if (point == after->points3D.end()) continue;
      if (std::binary_search(adjusted_ids.begin(), adjusted_ids.end(), point->first)) continue;
      const Eigen::Vector3d& was = before.points3D.at(point->first).xyz;
      const double depth = (before.images[i].cam_from_world * was).z();
      const auto ray = camera->second.CamFromImg(image.points2D[k]);
      if (!ray || !(depth > 0)) continue;
      point->second.xyz = image.cam_from_world.Inverse() * (depth * ray->homogeneous());
    }
  }
}

void UpdatePointErrors(SparseModel* model) {
  std::map<uint64_t, double> sums;
  for (const PosedImage& image : model->images) {
    const auto camera = model->cameras.find(image.camera_id);
    if (camera == model->cameras.end()) continue;
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      const auto point = model->points3D.find(image.point3D_ids[i]);
      if (point == model->points3D.end()) continue;
      const auto pixel = camera->second.ImgFromCam(image.cam_from_world * point->second.xyz);
      if (pixel) sums[point->first] += (*pixel - image.points2D[i]).norm();
    }
  }
  for (auto& [id, point] : model->points3D) {
    if (!point.track.empty()) point.error = sums[id] / static_cast<double>(point.track.size());
  }
}

}  // namespace

std::optional<BundleAdjustment> AdjustBundleInFull(const BundleAdjustmentOptions& options,
                                                   const SparseModel& model) {
  const std::map<uint32_t, LensFreedom> freedom = FreedomOfLenses(options, model);
  const Bundle bundle = MakeBundle(model, freedom, options.held_images);
  if (bundle.NumObservations() == 0) return std::nullopt;
  BundleValues values = ReadValues(bundle, freedom, model);
  BundleMinimizer minimizer(bundle, options.num_threads);
  Progress progress("Bundle adjustment, steps at most", 2 * options.max_num_iterations, 0,
                    Work::kRefinement);
  BundleAdjustment adjustment;
  const auto minimize = [&](const RobustLoss& loss) {
    const int before = adjustment.num_iterations;
    const Minimum minimum = minimizer.Run(
        loss, options.max_num_iterations, [&](int step) { progress.Update(before + step); },
        &values);
    adjustment.cost = minimum.cost;
    adjustment.is_converged = minimum.is_converged;
    adjustment.num_iterations += minimum.num_iterations;
  };
  minimize(options.loss);
  if (options.last_loss) {
    const double sigma = std::max(ResidualSigma(bundle, values), kMinResidualSigma);
    minimize({*options.last_loss, options.last_scale * sigma});
  }
  adjustment.error_sigma = ErrorsToResiduals(bundle) * ResidualSigma(bundle, values);
  AddSpreads(options, bundle, minimizer, values, &adjustment);
  adjustment.model = model;
  WriteValues(bundle, values, &adjustment.model);
  CarryLonePoints(model, bundle.point_id, &adjustment.model);
  UpdatePointErrors(&adjustment.model);
  return adjustment;
}

std::optional<SparseModel> AdjustBundle(const BundleAdjustmentOptions& options,
                                        const SparseModel& model) {
  std::optional<BundleAdjustment> adjustment = AdjustBundleInFull(options, model);
  if (!adjustment) return std::nullopt;
  return std::move(adjustment->model);
}

}  // namespace colmap_seapoint
