#include "examples/benchmarks/feature/pair_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr double kAltitude = 3;     // metres
constexpr double kBaseline = 0.75;  // metres, to the right in the picture
constexpr int kWidth = 800, kHeight = 600;
constexpr double kFocal = 800;
constexpr double kShift = kFocal * kBaseline / kAltitude;  // 200 pixels on the plane z = 0

// Two cameras that look straight down on z = height(x, y), the second kBaseline further along x.
SurveyTruth MakeTruth(const std::function<double(double, double)>& height) {
  SurveyTruth truth;
  GridSpec grid;
  grid.step = 0.01;
  grid.ix0 = grid.iy0 = -400;
  grid.nx = grid.ny = 801;
  Field heights;
  for (int j = 0; j < grid.ny; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      heights.push_back(static_cast<float>(height(grid.X(i), grid.Y(j))));
    }
  }
  truth.surface = HeightField(grid, std::move(heights));
  truth.gsd = kAltitude / kFocal;
  Camera camera = MakeCamera(CameraModel::kPinhole, kFocal, kWidth, kHeight);
  camera.camera_id = 1;
  truth.model.cameras[1] = camera;
  for (int i = 0; i < 2; ++i) {
    PosedImage image;
    image.image_id = static_cast<uint32_t>(i + 1);
    image.camera_id = 1;
    image.name = "picture" + std::to_string(i) + ".jpg";
    // x right, y down in the picture (world -y), z down.
    const Eigen::Matrix3d axes = Eigen::Vector3d(1, -1, -1).asDiagonal();
    image.cam_from_world.rotation = Eigen::Quaterniond(axes);
    image.cam_from_world.translation = -(axes * Eigen::Vector3d(i * kBaseline, 0, kAltitude));
    truth.model.images.push_back(image);
  }
  return truth;
}

SurveyTruth PlaneTruth() {
  return MakeTruth([](double, double) { return 0.0; });
}

// A wall 0.05 m thick and 1 m high at x = 0.35, across the whole field.
SurveyTruth WallTruth() {
  return MakeTruth([](double x, double) { return std::abs(x - 0.35) < 0.025 ? 1.0 : 0.0; });
}

TEST(SurveyOracleTest, PlaneShiftsThePicture) {
  const SurveyTruth truth = PlaneTruth();
  const SurveyOracle oracle(truth);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(300, 200), Eigen::Vector2d(799.5, 0.5)}) {
    const auto place = oracle.Transfer(0, pixel, 1);
    ASSERT_TRUE(place);
    EXPECT_LT((*place - (pixel - Eigen::Vector2d(kShift, 0))).norm(), 1e-6);
    EXPECT_TRUE(oracle.TransferVisible(0, pixel, 1));
  }
  // Beyond the left border of picture 1.
  EXPECT_TRUE(oracle.Transfer(0, {kShift - 1, 300}, 1));
  EXPECT_FALSE(oracle.TransferVisible(0, {kShift - 1, 300}, 1));
  EXPECT_EQ(oracle.ImageIdx("picture1.jpg"), 1u);
  EXPECT_THROW(oracle.ImageIdx("picture2.jpg"), Error);
}

TEST(SurveyOracleTest, WallHides) {
  const SurveyTruth truth = WallTruth();
  const SurveyOracle oracle(truth);
  // The place (0.3, 0, 0) left of the wall: the first camera sees it, the second looks from the
  // other side.
  const Eigen::Vector2d pixel(0.5 * kWidth + kFocal * 0.3 / kAltitude, 0.5 * kHeight);
  const auto place = oracle.Transfer(0, pixel, 1);
  ASSERT_TRUE(place);
  EXPECT_LT((*place - (pixel - Eigen::Vector2d(kShift, 0))).norm(), 1e-6);
  EXPECT_FALSE(oracle.TransferVisible(0, pixel, 1));
}

TEST(MatchPrecisionTest, CountsByDistanceFromTheTruePlace) {
  const SurveyTruth truth = PlaneTruth();
  const SurveyOracle oracle(truth);
  const std::vector<SeaPoint> points1 = {{400, 300}, {500, 200}, {600, 100}, {700, 500}};
  std::vector<SeaPoint> points2;
  for (const double error : {0.0, 1.9, 2.1, 50.0}) {
    const SeaPoint& point = points1[points2.size()];
    points2.push_back({static_cast<float>(point.x - kShift + 0.6 * error),
                       static_cast<float>(point.y + 0.8 * error)});
  }
  const FeatureMatches matches = {{0, 0}, {1, 1}, {2, 2}, {3, 3}};
  EXPECT_EQ(MatchPrecision(oracle, 0, 1, points1, points2, matches), 0.5);
  EXPECT_EQ(MatchPrecision(oracle, 0, 1, points1, points2, {{0, 0}, {1, 1}, {3, 0}}), 2.0 / 3);
  EXPECT_TRUE(std::isnan(MatchPrecision(oracle, 0, 1, points1, points2, {})));
  // All four are visible in picture 2; the first two are found again there.
  EXPECT_EQ(Repeatability(oracle, 0, 1, points1, points2), 0.5);
  // A point beyond the border does not count.
  EXPECT_EQ(Repeatability(oracle, 0, 1, {{400, 300}, {50, 300}}, points2), 1);
  EXPECT_TRUE(std::isnan(Repeatability(oracle, 0, 1, {{50, 300}}, points2)));
}

TEST(MatchPrecisionTest, AHiddenPlaceCountsByItsErrorAlone) {
  const SurveyTruth truth = WallTruth();
  const SurveyOracle oracle(truth);
  const SeaPoint hidden{static_cast<float>(0.5 * kWidth + kFocal * 0.3 / kAltitude), 300};
  const SeaPoint there{static_cast<float>(hidden.x - kShift), 300};
  EXPECT_EQ(MatchPrecision(oracle, 0, 1, {hidden}, {there}, {{0, 0}}), 1);
  EXPECT_TRUE(std::isnan(Repeatability(oracle, 0, 1, {hidden}, {there})));
}

TEST(TrulySharedTest, ExactOnThePlane) {
  const SurveyTruth truth = PlaneTruth();
  const SurveyOracle oracle(truth);
  const CellGrid grid(kWidth, kHeight, 8);
  const std::vector<uint8_t> shared = TrulyShared(oracle, 1, 0, grid);
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    // Picture 0 ends at the column kWidth - kShift of picture 1.
    ASSERT_EQ(shared[cell], grid.Center(cell).x() < kWidth - kShift ? 1 : 0) << cell;
  }
  const InfluenceMask nothing{grid, std::vector<uint8_t>(grid.Size(), 0)};
  const OverlapScore score = ScoreOverlap(nothing, shared, shared);
  EXPECT_EQ(score.true_overlap, 1 - kShift / kWidth);
  EXPECT_EQ(score.error, -score.true_overlap);
  EXPECT_EQ(score.recall, 0);
  EXPECT_TRUE(std::isnan(score.precision));
}

TEST(ScoreOverlapTest, CountsCells) {
  const CellGrid grid(8, 1, 1);
  const InfluenceMask mask{grid, {1, 1, 1, 0, 0, 1, 0, 0}};
  const std::vector<uint8_t> shared = {1, 1, 1, 1, 1, 0, 0, 0};
  const std::vector<uint8_t> textured = {1, 1, 0, 1, 0, 1, 1, 1};
  const OverlapScore score = ScoreOverlap(mask, shared, textured);
  EXPECT_EQ(score.true_overlap, 5.0 / 8);
  EXPECT_EQ(score.error, 4.0 / 8 - 5.0 / 8);
  EXPECT_EQ(score.textured, 3.0 / 5);
  EXPECT_EQ(score.recall, 2.0 / 3);
  EXPECT_EQ(score.precision, 3.0 / 4);
}

}  // namespace
}  // namespace colmap_seapoint
