#include "examples/survey/survey.h"

#include <array>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/paths/survey_camera.h"
#include "examples/survey/paths/survey_path.h"
#include "examples/survey/paths/survey_port.h"
#include "examples/survey/render/renderer.h"
#include "examples/survey/scene/landmarks.h"
#include "examples/survey/scene/seabed.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr double kFarT = 1e3;
constexpr int kPointsPerImage = 300;

Seabed MakeSeabed(const SurveyOptions& options) {
  return Seabed({static_cast<uint64_t>(options.seed), options.relief, NominalGsd(options)});
}

LandmarkOptions BoulderOptions(const SurveyOptions& options) {
  return {static_cast<uint64_t>(options.seed), BoulderRadius(options), BoulderHeight(options),
          options.relief, NominalGsd(options)};
}

LandmarkOptions StatueOptions(const SurveyOptions& options) {
  return {static_cast<uint64_t>(options.seed), StatueRadius(options), StatueHeight(options),
          options.relief, NominalGsd(options)};
}

// Bars about the places below pictures that lie evenly in the survey.
std::vector<MarkerBoard> PlanBars(const SurveyOptions& options, const SparseModel& model,
                                  const HeightField& ground) {
  std::vector<Eigen::Vector2d> places;
  const auto num_bars = static_cast<size_t>(options.markers);
  for (size_t k = 0; k < num_bars; ++k) {
    const PosedImage& image = model.images[(2 * k + 1) * model.images.size() / (2 * num_bars)];
    places.push_back(image.cam_from_world.OriginInSource().head<2>());
  }
  return MakeBars(places,
                  {static_cast<uint64_t>(options.seed), options.marker_bar, options.marker_size},
                  ground);
}

Surface MakeSurface(const SurveyOptions& options, const SparseModel& model,
                    std::vector<MarkerBoard>* boards) {
  const double lowest = -1.2 * options.relief - 0.05;
  const Rectangle box = SurveyArea(options, model, lowest);
  HeightField ground = MakeHeightField(MakeSeabed(options), box.min_x, box.min_y, box.max_x,
                                       box.max_y, options.num_threads);
  SEAPOINT_CHECK(ground.MinHeight() > lowest);
  Sheet object;
  *boards = PlanBars(options, model, ground);
  if (!boards->empty()) ground = WithBoards(ground, *boards);
  if (options.path == SurveyPath::kCircle) ground = WithBoulder(ground, BoulderOptions(options));
  if (options.path == SurveyPath::kStatue) {
    object = MakeStatue(StatueOptions(options), ground.Height(0, 0));
  }
  return Surface(std::move(ground), WorldFromGround(options), std::move(object));
}

// From a raster of rays in every picture.
double MeasureGsd(const SurveyTruth& truth) {
  constexpr int kSteps = 16;
  double sum = 0;
  int count = 0;
  for (const PosedImage& image : truth.model.images) {
    const PortCamera port_camera(truth.port, truth.model.cameras.at(image.camera_id));
    const Camera& camera = port_camera.InWater();
    const Rigid3d world_from_cam = image.cam_from_world.Inverse();
    for (int k = 0; k < kSteps * kSteps; ++k) {
      const auto ray = port_camera.Ray({camera.width * (k % kSteps + 0.5) / kSteps,
                                        camera.height * (k / kSteps + 0.5) / kSteps});
      if (!ray) continue;
      const auto t = truth.surface.IntersectRay(world_from_cam * ray->origin,
                                                world_from_cam.rotation * ray->direction, 0, kFarT);
      if (!t || *t * ray->direction.norm() > truth.max_range) continue;
      sum += GsdAt(camera, ray->origin + *t * ray->direction);
      ++count;
    }
  }
  SEAPOINT_CHECK(count > 0);
  return sum / count;
}

// A point under a random pixel of every picture in turn, kept when a second picture sees it too.
void AddExactPoints(const SurveyOptions& options, SurveyTruth* truth) {
  const SurfaceVisibility visibility(*truth);
  SparseModel* model = &truth->model;
  const size_t num_images = model->images.size();
  for (size_t k = 0; k < kPointsPerImage * num_images; ++k) {
    const PosedImage& seed_image = model->images[k % num_images];
    const PortCamera camera(truth->port, model->cameras.at(seed_image.camera_id));
    const auto random = [&](int axis) {
      return Uniform(Hash(static_cast<uint64_t>(options.seed) + 31, static_cast<int64_t>(k), axis));
    };
    const auto ray =
        camera.Ray({camera.InWater().width * random(0), camera.InWater().height * random(1)});
    if (!ray) continue;
    const Rigid3d world_from_cam = seed_image.cam_from_world.Inverse();
    const Eigen::Vector3d direction = world_from_cam.rotation * ray->direction;
    const auto hit = truth->surface.Trace(world_from_cam * ray->origin, direction, 0, kFarT);
    if (!hit) continue;
    SparsePoint point;
    point.xyz = hit->xyz;
    point.rgb = {128, 128, 128};
    std::vector<std::pair<size_t, Eigen::Vector2d>> views;
    for (size_t i = 0; i < num_images; ++i) {
      if (const auto pixel = visibility.Project(i, point.xyz, hit->normal))
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

SurveyTruth MakeSurveyTruth(const SurveyOptions& options, std::vector<PosedImage> more) {
  const std::string problem = CheckSurveyOptions(options);
  if (!problem.empty()) throw UsageError(problem);
  SurveyTruth truth;
  truth.model = PlanSurvey(options);
  for (PosedImage& image : more) {
    image.image_id = static_cast<uint32_t>(truth.model.images.size() + 1);
    truth.model.images.push_back(std::move(image));
  }
  truth.max_range = MaxRange(options);
  truth.port = options.port;
  truth.surface = MakeSurface(options, truth.model, &truth.boards);
  truth.gsd = MeasureGsd(truth);
  AddExactPoints(options, &truth);
  return truth;
}

void RenderSurvey(const SurveyOptions& options, const SurveyTruth& truth,
                  const std::function<void(const PosedImage&, ColorImage&&)>& take) {
  const Seabed seabed = MakeSeabed(options);
  Renderer renderer(options, truth.model.cameras.at(1), truth.surface, truth.boards, seabed);
  for (const PosedImage& image : truth.model.images) {
    take(image, renderer.Render(image, options.num_threads));
  }
}

}  // namespace colmap_seapoint
