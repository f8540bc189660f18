#include "colmap_seapoint/adjustment/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <random>

#include "colmap_seapoint/mapping/adjust_lens.h"
#include "tests/mapping/exact_survey.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

void AddOutliers(SparseModel* model) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (PosedImage& image : model->images) {
    for (size_t i = 0; i < image.points2D.size(); i += 50) {
      image.points2D[i] += Eigen::Vector2d(15 * uniform(random), 15 * uniform(random));
    }
  }
}

TEST(BundleAdjustmentTest, FindsTheWholeLensOfTwoStrips) {
  const SparseModel exact = ExactSurvey(ExactLens(), 8);
  const SparseModel start = Disturbed(exact);
  ASSERT_GT(LargestDifference(start.cameras.at(1), ExactLens()), 10);
  const SparseModel model = AdjustBundle({}, start).value();
  EXPECT_LT(ReprojectionError(model), 0.01);
  EXPECT_NEAR(model.cameras.at(1).FocalX(), 900, 0.2);
  EXPECT_NEAR(model.cameras.at(1).PrincipalX(), 504.6, 0.2);
  EXPECT_LT(LargestDifference(model.cameras.at(1), ExactLens()), 0.3);
}

TEST(BundleAdjustmentTest, OutliersHardlyCount) {
  SparseModel exact = ExactSurvey(ExactLens(), 8);
  AddOutliers(&exact);
  const SparseModel model = AdjustBundle({}, Disturbed(exact)).value();
  EXPECT_GT(ReprojectionError(model), 0.5);  // they are still there
  EXPECT_NEAR(model.cameras.at(1).FocalX(), 900, 1);
  EXPECT_NEAR(model.cameras.at(1).PrincipalX(), 504.6, 1);
}

TEST(BundleAdjustmentTest, HoldsThePrincipalPointWhenTold) {
  BundleAdjustmentOptions options;
  options.refine_principal_point = false;
  const SparseModel model = AdjustBundle(options, Disturbed(ExactSurvey(ExactLens(), 8))).value();
  EXPECT_EQ(model.cameras.at(1).PrincipalX(), 500);
  EXPECT_EQ(model.cameras.at(1).PrincipalY(), 375);
  EXPECT_NE(model.cameras.at(1).params[4], 0);
}

// Both solvers: of up to 50 pictures, and of more.
TEST(BundleAdjustmentTest, SameBytesEveryTime) {
  for (int pictures_a_strip : {8, 26}) {
    const SparseModel start = Disturbed(ExactSurvey(ExactLens(), pictures_a_strip));
    const SparseModel first = AdjustBundle({}, start).value();
    const SparseModel second = AdjustBundle({}, start).value();
    EXPECT_LT(LargestDifference(first.cameras.at(1), ExactLens()), 0.3);
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
  SparseModel model = ExactSurvey(ExactLens(), 3);
  for (PosedImage& image : model.images) {
    image.point3D_ids.assign(image.point3D_ids.size(), kNoPoint3D);
  }
  EXPECT_FALSE(AdjustBundle({}, model));
}

}  // namespace
}  // namespace colmap_seapoint
