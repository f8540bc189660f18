#include "colmap_seapoint/adjustment/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "colmap_seapoint/mapping/adjust_lens.h"
#include "tests/adjustment/ceres_reference.h"
#include "tests/adjustment/lawn_mower.h"
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

TEST(BundleAdjustmentTest, HeldPosesStayAndTheOthersComeToThem) {
  const SparseModel exact = ExactSurvey(ExactLens(), 8);
  SparseModel start = exact;
  BundleAdjustmentOptions options;
  options.lenses = AllLensesHeld(exact);
  for (PosedImage& image : start.images) {
    if (image.image_id <= 13) {
      options.held_images.insert(image.image_id);
    } else {
      image.cam_from_world.translation += Eigen::Vector3d(0.02, -0.01, 0.015);
    }
  }
  const SparseModel model = AdjustBundle(options, start).value();
  EXPECT_EQ(model.cameras.at(1).params, exact.cameras.at(1).params);
  ASSERT_EQ(model.images.size(), 16u);
  for (size_t i = 0; i < model.images.size(); ++i) {
    const Rigid3d& is = model.images[i].cam_from_world;
    const Rigid3d& truth = exact.images[i].cam_from_world;
    if (options.held_images.count(model.images[i].image_id) > 0) {
      EXPECT_EQ(is.translation, truth.translation);
      EXPECT_EQ(is.rotation.coeffs(), truth.rotation.coeffs());
    } else {
      EXPECT_LT((is.translation - truth.translation).norm(), 1e-6);
    }
  }
}

void AddNoise(double sigma, SparseModel* model) {
  std::mt19937 random(10);
  std::normal_distribution<double> normal(0, sigma);
  for (PosedImage& image : model->images) {
    for (Eigen::Vector2d& pixel : image.points2D) {
      pixel += Eigen::Vector2d(normal(random), normal(random));
    }
  }
}

TEST(BundleAdjustmentTest, SameBytesForAnyNumberOfThreads) {
  SparseModel start = ExactSurvey(ExactLens(), 8);
  AddNoise(0.3, &start);
  start = Disturbed(start);
  BundleAdjustmentOptions options;
  const SparseModel first = AdjustBundle(options, start).value();
  for (int num_threads : {1, 2, 5}) {
    options.num_threads = num_threads;
    const SparseModel second = AdjustBundle(options, start).value();
    EXPECT_EQ(first.cameras.at(1).params, second.cameras.at(1).params);
    for (const auto& [id, point] : first.points3D) {
      EXPECT_EQ(point.xyz, second.points3D.at(id).xyz);
    }
    for (size_t i = 0; i < first.images.size(); ++i) {
      EXPECT_EQ(first.images[i].cam_from_world.translation,
                second.images[i].cam_from_world.translation);
    }
  }
}

TEST(BundleAdjustmentTest, FindsTheMinimumThatCeresFinds) {
  SparseModel start = ExactSurvey(ExactLens(), 8);
  AddNoise(0.4, &start);
  start = Disturbed(start);
  BundleAdjustmentOptions options;
  options.last_loss.reset();
  options.principal_point_sigma = 0;
  const BundleAdjustment ours = AdjustBundleInFull(options, start).value();
  EXPECT_TRUE(ours.is_converged);
  SparseModel theirs = start;
  const double cost = AdjustByCeres(0.5, &theirs);
  EXPECT_NEAR(ours.cost, cost, 1e-5 * cost);
  const std::vector<double>& sigmas = ours.lens_sigmas.at(1);
  for (size_t k = 0; k < 8; ++k) {
    EXPECT_NEAR(ours.model.cameras.at(1).params[k], theirs.cameras.at(1).params[k], 0.1 * sigmas[k])
        << k;
  }
}

// The lens is found as well as is said: some 2 of 8 parameters are off by more than a sigma, none
// by more than four.
TEST(BundleAdjustmentTest, SigmasOfTheLensSayHowFarItIsOff) {
  SparseModel start = ExactSurvey(ExactLens(), 8);
  AddNoise(0.3, &start);
  BundleAdjustmentOptions options;
  options.principal_point_sigma = 0;
  options.last_loss.reset();
  const BundleAdjustment ours = AdjustBundleInFull(options, start).value();
  EXPECT_NEAR(ours.error_sigma, 0.3, 0.05);
  double sum = 0;
  for (size_t k = 0; k < 8; ++k) {
    const double off = ours.model.cameras.at(1).params[k] - ExactLens().params[k];
    EXPECT_LT(std::abs(off), 4 * ours.lens_sigmas.at(1)[k]) << k;
    sum += std::pow(off / ours.lens_sigmas.at(1)[k], 2);
  }
  EXPECT_GT(sum, 0.8);
}

TEST(BundleAdjustmentTest, HoldsAndTiesWhatIsAsked) {
  BundleAdjustmentOptions options;
  options.lenses[1] = {0b11100000, true, 0};  // k2, p1, p2
  const SparseModel start = Disturbed(ExactSurvey(ExactLens(), 8));
  const BundleAdjustment ours = AdjustBundleInFull(options, start).value();
  const std::vector<double>& params = ours.model.cameras.at(1).params;
  EXPECT_EQ(params[0], params[1]);
  EXPECT_NE(params[0], start.cameras.at(1).params[0]);
  EXPECT_NE(params[4], 0);
  for (size_t k : {5, 6, 7}) {
    EXPECT_EQ(params[k], 0);
    EXPECT_EQ(ours.lens_sigmas.at(1)[k], 0);
  }
}

// GSD: 2 units / 900 pixels.
TEST(BundleAdjustmentTest, APriorOfTheFocalLengthCountsByItsSigma) {
  const SparseModel start = Disturbed(ExactSurvey(ExactLens(), 5));
  BundleAdjustmentOptions options;
  options.lenses[1].focal_prior = 950;
  options.lenses[1].focal_sigma = 1e-4;
  const Camera firm = AdjustBundle(options, start)->cameras.at(1);
  EXPECT_NEAR(firm.FocalX(), 950, 0.5);
  EXPECT_NEAR(firm.FocalY(), 950, 0.5);
  options.lenses[1].focal_sigma = 500;
  EXPECT_NEAR(AdjustBundle(options, start)->cameras.at(1).FocalX(), 900, 0.5);
}

TEST(BundleAdjustmentTest, AThousandPicturesBendBack) {
  const SparseModel exact = LawnMower(10, 100, 60);
  const SparseModel start = Bent(exact, 0.5);
  ASSERT_GT(CentersRms(start, exact), 0.05);
  BundleAdjustmentOptions options;
  options.num_threads = 2;
  const BundleAdjustment ours = AdjustBundleInFull(options, start).value();
  EXPECT_TRUE(ours.is_converged);
  EXPECT_LT(CentersRms(ours.model, exact), 0.01 * 2 / 900);
}

TEST(BundleAdjustmentTest, TwoStripsOfFiveHundredBendBack) {
  const SparseModel exact = LawnMower(2, 500, 60);
  const SparseModel start = Bent(exact, 0.5);
  BundleAdjustmentOptions options;
  options.num_threads = 2;
  const BundleAdjustment ours = AdjustBundleInFull(options, start).value();
  EXPECT_TRUE(ours.is_converged);
  EXPECT_LT(CentersRms(ours.model, exact), 0.01 * 2 / 900);
}

TEST(BundleAdjustmentTest, BadInputIsPassedOver) {
  SparseModel model = Disturbed(ExactSurvey(ExactLens(), 4));
  model.images[0].camera_id = 99;
  model.images[1].points2D[5].x() = std::nan("");
  model.images[2].cam_from_world.translation.z() -= 100;
  model.points3D.begin()->second.xyz.setConstant(std::nan(""));
  model.points3D.rbegin()->second.track.push_back({12345, 0});
  model.images[3].point3D_ids[0] = 987654321;
  const auto adjusted = AdjustBundle({}, model);
  ASSERT_TRUE(adjusted);
  EXPECT_EQ(adjusted->images[2].cam_from_world.translation,
            model.images[2].cam_from_world.translation);
  EXPECT_TRUE(adjusted->images[4].cam_from_world.translation.allFinite());
  EXPECT_FALSE(AdjustBundle({}, SparseModel()));
  model.images.resize(1);
  EXPECT_FALSE(AdjustBundle({}, model));
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
