#include "tests/lens/noisy_survey.h"

#include <random>

#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {

SparseModel NoisySurvey(const Camera& lens, int pictures_a_strip, double sigma, unsigned seed) {
  SparseModel survey = ExactSurvey(lens, pictures_a_strip);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, sigma);
  for (PosedImage& image : survey.images) {
    for (Eigen::Vector2d& pixel : image.points2D) {
      pixel.x() += noise(random);
      pixel.y() += noise(random);
    }
  }
  return survey;
}

Camera LensOf(CameraModel model, const std::vector<double>& params) {
  Camera camera = MakeCamera(model, 900, 1000, 750);
  camera.camera_id = 1;
  camera.params = params;
  return camera;
}

}  // namespace colmap_seapoint
