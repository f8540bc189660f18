#include "colmap_seapoint/lens/refraction_sign.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/lens/noisy_survey.h"
#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

// Moves every observation outwards by so many pixels times the radius cubed and how much nearer
// than 1.8 the place is.
SparseModel AsThroughPort(SparseModel model, double pixels) {
  const Camera& camera = model.cameras.at(1);
  const Eigen::Vector2d middle(camera.PrincipalX(), camera.PrincipalY());
  for (PosedImage& image : model.images) {
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      const Eigen::Vector3d in_cam =
          image.cam_from_world * model.points3D.at(image.point3D_ids[k]).xyz;
      const double size =
          pixels * std::pow(in_cam.hnormalized().norm(), 3) * (1.8 / in_cam.z() - 1);
      image.points2D[k] += size * (image.points2D[k] - middle).normalized();
    }
  }
  return model;
}

TEST(RefractionSignTest, NoiseGivesNone) {
  double squares = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const double sign = RefractionSign(NoisySurvey(ExactLens(), 5, 0.1, seed));
    squares += sign * sign / 20;
    EXPECT_LT(std::abs(sign), 4);
  }
  EXPECT_NEAR(std::sqrt(squares), 1, 0.4);
}

TEST(RefractionSignTest, WhatGrowsWithRadiusAndNearnessShows) {
  EXPECT_GT(RefractionSign(AsThroughPort(NoisySurvey(ExactLens(), 10, 0.1), 5)), 3.5);
  EXPECT_LT(RefractionSign(AsThroughPort(NoisySurvey(ExactLens(), 10, 0.1), -5)), -3.5);
}

TEST(RefractionSignTest, BadModels) {
  EXPECT_EQ(RefractionSign(SparseModel()), 0);
  SparseModel model = NoisySurvey(ExactLens(), 5, 0.1);
  model.cameras.clear();
  EXPECT_EQ(RefractionSign(model), 0);
}

}  // namespace
}  // namespace colmap_seapoint
