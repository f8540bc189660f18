#include "examples/survey/survey.h"

#include <array>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/renderer.h"
#include "examples/survey/scene/seabed.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr double kFarT = 1e3;
constexpr size_t kMaxAlbedoBytes = size_t{768} << 20;
constexpr int kPointsPerImage = 300;

Seabed MakeSeabed(const SurveyOptions& options) {
  return Seabed({static_cast<uint64_t>(options.seed), options.relief, NominalGsd(options)});
}

// Mean depth over mean focal length, from a raster of rays in every picture.
double MeasureGsd(const SparseModel& model, const HeightField& surface) {
  constexpr int kSteps = 16;
  double sum = 0;
  int count = 0;
  for (const PosedImage& image : model.images) {
    const Camera& camera = model.cameras.at(image.camera_id);
    const Rigid3d world_from_cam = image.cam_from_world.Inverse();
    for (int k = 0; k < kSteps * kSteps; ++k) {
      const auto ray = camera.CamFromImg({camera.width * (k % kSteps + 0.5) / kSteps,
                                          camera.height * (k / kSteps + 0.5) / kSteps});
      if (!ray) continue;
      // The ray has z = 1 in the camera: t is the depth.
      const auto t = surface.IntersectRay(world_from_cam.translation,
                                          world_from_cam.rotation * ray->homogeneous(), 0, kFarT);
      if (!t) continue;
      sum += *t / camera.MeanFocal();
      ++count;
    }
  }
  SEAPOINT_CHECK(count > 0);
  return sum / count;
}

// A point under a random pixel of every picture in turn, kept when a second picture sees it too.
void AddExactPoints(const SurveyOptions& options, const HeightField& surface, SparseModel* model) {
  const SurfaceVisibility visibility(*model, surface);
  const size_t num_images = model->images.size();
  for (size_t k = 0; k < kPointsPerImage * num_images; ++k) {
    const PosedImage& seed_image = model->images[k % num_images];
    const Camera& camera = model->cameras.at(seed_image.camera_id);
    const auto random = [&](int axis) {
      return Uniform(Hash(static_cast<uint64_t>(options.seed) + 31, static_cast<int64_t>(k), axis));
    };
    const auto ray = camera.CamFromImg({camera.width * random(0), camera.height * random(1)});
    if (!ray) continue;
    const Rigid3d world_from_cam = seed_image.cam_from_world.Inverse();
    const Eigen::Vector3d direction = world_from_cam.rotation * ray->homogeneous();
    const auto t = surface.IntersectRay(world_from_cam.translation, direction, 0, kFarT);
    if (!t) continue;
    SparsePoint point;
    point.xyz = world_from_cam.translation + *t * direction;
    point.rgb = {128, 128, 128};
    const Eigen::Vector3d normal = surface.Normal(point.xyz.x(), point.xyz.y());
    std::vector<std::pair<size_t, Eigen::Vector2d>> views;
    for (size_t i = 0; i < num_images; ++i) {
      if (const auto pixel = visibility.Project(i, point.xyz, normal))
        views.emplace_back(i, *pixel);
    }
    if (views.size() < 2) continue;
    const uint64_t id = model->points3D.size() + 1;
    for (const auto& [i, pixel] : views) {
      PosedImage& image = model->images[i];
      point.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.push_back(pixel);
      image.point3D_ids.push_back(id);
    }
    model->points3D.emplace(id, std::move(point));
  }
}

}  // namespace

SurveyTruth MakeSurveyTruth(const SurveyOptions& options) {
  const std::string problem = CheckSurveyOptions(options);
  if (!problem.empty()) throw UsageError(problem);
  SurveyTruth truth;
  truth.model = PlanSurvey(options);
  const double lowest = -1.2 * options.relief - 0.05;
  Rectangle box =
      Footprint(truth.model.cameras.at(1), truth.model.images[0].cam_from_world, lowest);
  for (const PosedImage& image : truth.model.images) {
    box = Union(box, Footprint(truth.model.cameras.at(1), image.cam_from_world, lowest));
  }
  truth.surface = MakeHeightField(MakeSeabed(options), box.min_x, box.min_y, box.max_x, box.max_y,
                                  options.num_threads);
  SEAPOINT_CHECK(truth.surface.MinHeight() > lowest);
  truth.gsd = MeasureGsd(truth.model, truth.surface);
  AddExactPoints(options, truth.surface, &truth.model);
  return truth;
}

void RenderSurvey(const SurveyOptions& options, const SurveyTruth& truth,
                  const std::function<void(const PosedImage&, ColorImage&&)>& take) {
  const Seabed seabed = MakeSeabed(options);
  const HeightField& surface = truth.surface;
  AlbedoMap albedo(seabed, surface.Grid().MinX(), surface.Grid().MinY(), surface.Grid().MaxX(),
                   surface.Grid().MaxY(), kMaxAlbedoBytes);
  Renderer renderer(options, truth.model.cameras.at(1), surface, &albedo);
  for (const PosedImage& image : truth.model.images) {
    take(image, renderer.Render(image, options.num_threads));
  }
}

}  // namespace colmap_seapoint
