#include "colmap_seapoint/lens/ground_bend.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/lens/lens_doubt.h"
#include "tests/lens/noisy_survey.h"
#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

constexpr double kCurvature = 0.01;

double Square(double x) { return x * x; }

TEST(GroundBendTest, TheFrameLiesOnTheGroundAlongTheStrips) {
  const auto frame = FindGroundFrame(ExactSurvey(ExactLens(), 8));
  ASSERT_TRUE(frame);
  EXPECT_GT(std::abs(frame->along.x()), 0.99);
  EXPECT_GT(std::abs(frame->up.z()), 0.99);
  EXPECT_NEAR(frame->distance, 1.8, 0.15);
  EXPECT_FALSE(FindGroundFrame(SparseModel()));
}

TEST(GroundBendTest, ABendAndAnotherFrameComeBackAsTheBend) {
  const SparseModel a = ExactSurvey(ExactLens(), 8);
  const auto frame = FindGroundFrame(a);
  ASSERT_TRUE(frame);
  SparseModel b = a;
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  for (auto& [id, point] : b.points3D) {
    point.xyz += kCurvature * Square(frame->along.dot(point.xyz - frame->centre)) * frame->up;
    point.xyz = 3 * (turn * point.xyz) + Eigen::Vector3d(5, 6, 7);
  }
  EXPECT_NEAR(CurvatureBetween(a, b, *frame), kCurvature, 0.02 * kCurvature);
  EXPECT_NEAR(CurvatureBetween(a, a, *frame), 0, 1e-12);
  EXPECT_EQ(CurvatureBetween(a, SparseModel(), *frame), 0);
}

double WeightedMoves(const SparseModel& model, const std::vector<Eigen::Vector3d>& weights,
                     const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& move) {
  double sum = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i].dot(move(model.images[i].cam_from_world.OriginInSource()));
  }
  return sum;
}

TEST(GroundBendTest, WeightsSeeABend) {
  const SparseModel model = ExactSurvey(ExactLens(), 8);
  const auto frame = FindGroundFrame(model);
  ASSERT_TRUE(frame);
  const auto weights = CurvatureWeights(model, *frame);
  ASSERT_EQ(weights.size(), model.images.size());
  EXPECT_NEAR(WeightedMoves(model, weights,
                            [&](const Eigen::Vector3d& centre) -> Eigen::Vector3d {
                              const double u = frame->along.dot(centre - frame->centre);
                              return kCurvature * u * u * frame->up;
                            }),
              kCurvature, 1e-9);
  EXPECT_TRUE(CurvatureWeights(SparseModel(), *frame).empty());
}

TEST(GroundBendTest, GrowsWithTheSquareOfTheLength) {
  const SparseModel model = ExactSurvey(ExactLens(), 4);
  const auto frame = FindGroundFrame(model);
  ASSERT_TRUE(frame);
  double half = 0;
  for (const PosedImage& image : model.images) {
    half = std::max(
        half, std::abs(frame->along.dot(image.cam_from_world.OriginInSource() - frame->centre)));
  }
  const GroundBend bend = BendInGsd(1e-3, model, *frame);
  const double gsd = frame->distance / model.cameras.at(1).MeanFocal();
  EXPECT_NEAR(bend.whole, 1e-3 * half * half / gsd, 1e-9);
  const double half_way = std::min(half, 2.5 * frame->distance);
  EXPECT_NEAR(bend.near, 1e-3 * half_way * half_way / gsd, 1e-9);
}

// What the equations say of the curvature's uncertainty against what noise does to it.
TEST(GroundBendTest, TheUncertaintyIsThatOfManySurveys) {
  constexpr int kSurveys = 30;
  constexpr double kSigma = 0.2;
  BundleAdjustmentOptions options;
  options.lenses[1].ties_focals = true;
  options.loss = {LossKind::kSquares, 1};
  options.last_loss.reset();
  Camera lens = ExactLens();
  lens.params[1] = lens.params[0];
  const SparseModel exact = ExactSurvey(lens, 4);
  const auto frame = FindGroundFrame(exact);
  ASSERT_TRUE(frame);
  options.centre_weights = CurvatureWeights(exact, *frame);
  double squares = 0, variance = 0;
  for (int k = 0; k < kSurveys; ++k) {
    const auto adjusted =
        AdjustBundleInFull(options, NoisySurvey(lens, 4, kSigma, static_cast<unsigned>(k)));
    ASSERT_TRUE(adjusted);
    double curvature = 0;
    for (size_t i = 0; i < exact.images.size(); ++i) {
      curvature +=
          options.centre_weights[i].dot(adjusted->model.images[i].cam_from_world.OriginInSource() -
                                        exact.images[i].cam_from_world.OriginInSource());
    }
    squares += Square(curvature) / kSurveys;
    variance += Square(adjusted->centre_sigma) / kSurveys;
    EXPECT_NEAR(adjusted->error_sigma, kSigma, 0.1 * kSigma);
  }
  EXPECT_NEAR(std::sqrt(squares / variance), 1, 0.3);
}

TEST(LensDoubtTest, SaysWhatIsOpenAndWhatWouldTell) {
  EXPECT_EQ(Say({{0.3, 0.3}, "the distortion"}),
            "the ground may be bent by 0.3 GSD over 5 times the camera's distance");
  const std::string transect = Say({{0.1, 46.4}, ""});
  EXPECT_NE(transect.find("0.1 GSD"), std::string::npos);
  EXPECT_NE(transect.find("by 46 over the whole survey"), std::string::npos);
  EXPECT_NE(transect.find("positions"), std::string::npos);
  const std::string open = Say({{12.34, 12.34}, "the distortion"});
  EXPECT_NE(open.find("12.3 GSD"), std::string::npos);
  EXPECT_EQ(open.find("whole survey"), std::string::npos);
  EXPECT_NE(open.find("trades places with the distortion"), std::string::npos);
  EXPECT_NE(open.find("a strip crosswise"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
