#include "colmap_seapoint/mapping/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "colmap_seapoint/mapping/adjust_lens.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kHeight = 2;

// Two strips over ground with some relief, flown there and back, as every picture saw it exactly.
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
    image.cam_from_world = StandAt(camera, center, turn_deg).cam_from_world;
    model.images.push_back(image);
  }
  const double length = spacing * pictures_a_strip;
  for (uint64_t id = 1; id <= 150 * static_cast<uint64_t>(pictures_a_strip); ++id) {
    SparsePoint point;
    point.xyz = {(length + 2) * uniform(random) - 1, 3 * uniform(random) - 1,
                 kHeight - 0.4 * uniform(random)};
    for (PosedImage& image : model.images) {
      const auto pixel = camera.ImgFromCam(image.cam_from_world * point.xyz);
      if (!pixel || !camera.InImage(*pixel)) continue;
      point.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.push_back(*pixel);
      image.point3D_ids.push_back(id);
    }
    model.points3D[id] = point;
  }
  return model;
}

// As a mapper leaves it that knew neither distortion nor principal point.
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

void AddOutliers(SparseModel* model) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (PosedImage& image : model->images) {
    for (size_t i = 0; i < image.points2D.size(); i += 50) {
      image.points2D[i] += Eigen::Vector2d(15 * uniform(random), 15 * uniform(random));
    }
  }
}

Camera Lens() {
  Camera camera = MakeCamera(CameraModel::kOpenCV, 900, 1000, 750);
  camera.camera_id = 1;
  camera.params = {900, 901.5, 504.6, 372, -0.11, 0.045, 0.0004, -0.0003};
  return camera;
}

// The largest distance, in pixels, between where two lenses put the same directions.
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

TEST(BundleAdjustmentTest, FindsTheWholeLensOfTwoStrips) {
  const SparseModel exact = ExactSurvey(Lens(), 8);
  const SparseModel start = Disturbed(exact);
  ASSERT_GT(LargestDifference(start.cameras.at(1), Lens()), 10);
  const SparseModel model = AdjustBundle({}, start).value();
  EXPECT_LT(ReprojectionError(model), 0.01);
  EXPECT_NEAR(model.cameras.at(1).FocalX(), 900, 0.2);
  EXPECT_NEAR(model.cameras.at(1).PrincipalX(), 504.6, 0.2);
  EXPECT_LT(LargestDifference(model.cameras.at(1), Lens()), 0.3);
}

TEST(BundleAdjustmentTest, OutliersHardlyCount) {
  SparseModel exact = ExactSurvey(Lens(), 8);
  AddOutliers(&exact);
  const SparseModel model = AdjustBundle({}, Disturbed(exact)).value();
  EXPECT_GT(ReprojectionError(model), 0.5);  // they are still there
  EXPECT_NEAR(model.cameras.at(1).FocalX(), 900, 1);
  EXPECT_NEAR(model.cameras.at(1).PrincipalX(), 504.6, 1);
}

TEST(BundleAdjustmentTest, HoldsThePrincipalPointWhenTold) {
  BundleAdjustmentOptions options;
  options.refine_principal_point = false;
  const SparseModel model = AdjustBundle(options, Disturbed(ExactSurvey(Lens(), 8))).value();
  EXPECT_EQ(model.cameras.at(1).PrincipalX(), 500);
  EXPECT_EQ(model.cameras.at(1).PrincipalY(), 375);
  EXPECT_NE(model.cameras.at(1).params[4], 0);
}

// Both solvers: of up to 50 pictures, and of more.
TEST(BundleAdjustmentTest, SameBytesEveryTime) {
  for (int pictures_a_strip : {8, 26}) {
    const SparseModel start = Disturbed(ExactSurvey(Lens(), pictures_a_strip));
    const SparseModel first = AdjustBundle({}, start).value();
    const SparseModel second = AdjustBundle({}, start).value();
    EXPECT_LT(LargestDifference(first.cameras.at(1), Lens()), 0.3);
    EXPECT_EQ(first.cameras.at(1).params, second.cameras.at(1).params);
    for (const auto& [id, point] : first.points3D) {
      EXPECT_EQ(point.xyz, second.points3D.at(id).xyz);
    }
  }
}

TEST(BundleAdjustmentTest, EveryCameraModelIsAdjusted) {
  for (CameraModel camera_model : RectifiableCameraModels()) {
    Camera lens = MildCamera(camera_model, 900, 1000, 750);
    lens.camera_id = 1;
    SparseModel model = ExactSurvey(lens, 5);
    model.cameras.at(1).params[0] *= 1.01;
    const auto adjusted = AdjustBundle({}, model);
    ASSERT_TRUE(adjusted) << static_cast<int>(camera_model);
    EXPECT_GT(ReprojectionError(model), 1) << static_cast<int>(camera_model);
    EXPECT_LT(ReprojectionError(*adjusted), 0.02) << static_cast<int>(camera_model);
  }
}

TEST(BundleAdjustmentTest, AModelWithoutPointsCannotBeAdjusted) {
  SparseModel model = ExactSurvey(Lens(), 3);
  for (PosedImage& image : model.images) {
    image.point3D_ids.assign(image.point3D_ids.size(), kNoPoint3D);
  }
  EXPECT_FALSE(AdjustBundle({}, model));
}

}  // namespace
}  // namespace colmap_seapoint
