#include "tests/mapping/exact_survey.h"

#include <algorithm>
#include <random>
#include <string>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kHeight = 2;

}  // namespace

Camera ExactLens() {
  Camera camera = MakeCamera(CameraModel::kOpenCV, 900, 1000, 750);
  camera.camera_id = 1;
  camera.params = {900, 901.5, 504.6, 372, -0.11, 0.045, 0.0004, -0.0003};
  return camera;
}

void Observe(const Camera& camera, uint64_t id, PosedImage* image, SparsePoint* point) {
  const auto pixel = camera.ImgFromCam(image->cam_from_world * point->xyz);
  if (!pixel || !camera.InImage(*pixel)) return;
  point->track.push_back({image->image_id, static_cast<uint32_t>(image->points2D.size())});
  image->points2D.push_back(*pixel);
  image->point3D_ids.push_back(id);
}

SparseModel ExactSurvey(const Camera& camera, int pictures_a_strip) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  SparseModel model;
  model.cameras[1] = camera;
  const double spacing = 0.4;
  for (int k = 0; k < 2 * pictures_a_strip; ++k) {
    const bool is_back = k >= pictures_a_strip;
    const Eigen::Vector3d turn_deg(4 * uniform(random) - 2, 4 * uniform(random) - 2,
                                   is_back ? 178 : 2);
    const Eigen::Vector3d center(spacing * (k % pictures_a_strip), is_back ? 1.0 : 0,
                                 0.1 * uniform(random));
    PosedImage image;
    image.image_id = static_cast<uint32_t>(k + 1);
    image.camera_id = 1;
    image.name = "img" + std::to_string(k + 1) + ".jpg";
    image.cam_from_world = StandAt(camera, center, turn_deg).cam_from_world;
    model.images.push_back(image);
  }
  const double length = spacing * pictures_a_strip;
  for (uint64_t id = 1; id <= 150 * static_cast<uint64_t>(pictures_a_strip); ++id) {
    SparsePoint point;
    point.xyz = {(length + 2) * uniform(random) - 1, 3 * uniform(random) - 1,
                 kHeight - 0.4 * uniform(random)};
    for (PosedImage& image : model.images) Observe(camera, id, &image, &point);
    model.points3D[id] = point;
  }
  return model;
}

SparseModel Disturbed(SparseModel model) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  Camera& camera = model.cameras.at(1);
  camera = [&] {
    Camera guess = MakeCamera(camera.model, 1.04 * camera.MeanFocal(), camera.width, camera.height);
    guess.camera_id = camera.camera_id;
    return guess;
  }();
  for (PosedImage& image : model.images) image.cam_from_world.translation += noise(0.01);
  for (auto& [id, point] : model.points3D) point.xyz += noise(0.01);
  return model;
}

double LargestDifference(const Camera& a, const Camera& b) {
  double largest = 0;
  for (double x = -0.5; x <= 0.5; x += 0.1) {
    for (double y = -0.38; y <= 0.38; y += 0.095) {
      const Eigen::Vector3d direction(x, y, 1);
      largest = std::max(largest, (*a.ImgFromCam(direction) - *b.ImgFromCam(direction)).norm());
    }
  }
  return largest;
}

}  // namespace colmap_seapoint
