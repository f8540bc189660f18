#include "tests/densify/pair_scene.h"

#include <random>

namespace colmap_seapoint {

PairScene::PairScene(const World& the_world, const Viewpoint& viewpoint1,
                     const Viewpoint& viewpoint2)
    : world(the_world),
      view1(viewpoint1),
      view2(viewpoint2),
      picture1(PictureOf(TakePicture(world, view1))),
      luma2(LumaOf(TakePicture(world, view2))) {}

PairInput PairScene::Input(const PartialDensificationOptions& options, int num_seeds) const {
  PairInput input;
  input.view1 = {0, view1.camera, view1.cam_from_world};
  input.view2 = {1, view2.camera, view2.cam_from_world};
  input.picture1 = &picture1;
  input.luma2 = &luma2;
  input.known.grid = CellsOf(view1.camera, options.step);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> x(0, view1.camera.width), y(0, view1.camera.height);
  for (int trial = 0; trial < 100 * num_seeds; ++trial) {
    if (static_cast<int>(input.seeds.size()) == num_seeds) break;
    const Eigen::Vector2d pixel1(x(generator), y(generator));
    const auto point = SurfaceAt(world, view1, pixel1);
    const auto pixel2 = point ? PixelOf(world, view2, *point) : std::nullopt;
    if (pixel2) input.seeds.push_back({pixel1, *pixel2});
  }
  return input;
}

Accuracy MeasureAccuracy(const PairScene& scene, const PartialCloud& cloud, double gsd) {
  Accuracy accuracy;
  const double share = 1.0 / static_cast<double>(cloud.points.size());
  for (const DensePoint& point : cloud.points) {
    const double distance = scene.world.Distance(point.xyz.cast<double>());
    accuracy.half_gsd += distance <= 0.5 * gsd ? share : 0;
    accuracy.one_gsd += distance <= gsd ? share : 0;
    accuracy.two_gsd += distance <= 2 * gsd ? share : 0;
  }
  return accuracy;
}

double MeasureCoverage(const PairScene& scene, const PartialCloud& cloud, double gsd) {
  const Camera& camera = scene.view1.camera;
  GrayImage hit(camera.width, camera.height);
  for (const DensePoint& point : cloud.points) {
    const Eigen::Vector3d xyz = point.xyz.cast<double>();
    const auto pixel = camera.ImgFromCam(scene.view1.cam_from_world * xyz);
    if (!pixel || !camera.InImage(*pixel) || scene.world.Distance(xyz) > 2 * gsd) continue;
    const int x = std::min(camera.width - 1, static_cast<int>(pixel->x()));
    const int y = std::min(camera.height - 1, static_cast<int>(pixel->y()));
    hit.At(x, y) = 1;
  }
  int64_t num_seen = 0, num_covered = 0;
  for (int y = 2; y < camera.height - 2; y += 4) {
    for (int x = 2; x < camera.width - 2; x += 4) {
      const auto point = SurfaceAt(scene.world, scene.view1, {x + 0.5, y + 0.5});
      if (!point || !PixelOf(scene.world, scene.view2, *point)) continue;
      ++num_seen;
      bool covered = false;
      for (int v = -2; v <= 2; ++v) {
        for (int u = -2; u <= 2; ++u) covered = covered || hit.At(x + u, y + v);
      }
      num_covered += covered;
    }
  }
  return static_cast<double>(num_covered) / static_cast<double>(num_seen);
}

}  // namespace colmap_seapoint
