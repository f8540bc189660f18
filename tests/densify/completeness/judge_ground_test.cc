#include "densify/completeness/judge_ground.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

const Eigen::Vector2d kPlace(0.1, 1.9);
constexpr double kSide = kCellSpacings * kFlatGsd;

int CellOf(double at) { return static_cast<int>(std::floor(at / kSide)); }

// A strip that was blurred as a whole, over points at these heights, in cells' sides.
GroundCell BlurredCellAt(const std::function<double(int x, int y)>& height) {
  const SparseModel model = MakeFlatSurvey({1, 4, 1.6, 3.2});
  CompletenessInput input = FlatInput(model, [](const Eigen::Vector2d&) { return true; });
  for (PictureFacts& facts : input.facts) facts.is_bad = true;
  const auto flat = input.for_each_point;
  input.for_each_point = [&](const auto& take) {
    flat([&](ConfidentPoint point) {
      Eigen::Vector3d& xyz = point.place.xyz;
      xyz.z() = kSide * height(CellOf(xyz.x()), CellOf(xyz.y()));
      take(point);
    });
  };
  CompletenessOptions options;
  options.spacing = kFlatGsd;
  const CompletenessResult result = AssessCompleteness(input, options, 1);
  return *result.ground.layers.at({Side::kTop, 0})
              .cells.Find(CellOf(kPlace.x()), CellOf(kPlace.y()));
}

TEST(JudgeGround, BlurredPicturesCoverWhatTheyShowSmooth) {
  EXPECT_TRUE(BlurredCellAt([](int, int) { return 0.0; }).is_covered);
}

TEST(JudgeGround, BlurredPicturesDoNotCoverWhatTheyShowRough) {
  const GroundCell cell = BlurredCellAt([](int x, int y) { return 0.8 * ((x + y + 3000) % 3); });
  EXPECT_FALSE(cell.is_covered);
  EXPECT_EQ(cell.cause, GapCause::kBadPicture);
}

// The surroundings tell it, and not a single cell that stands out.
TEST(JudgeGround, OneRoughCellInASmoothPlaceIsCovered) {
  const int x0 = CellOf(kPlace.x()), y0 = CellOf(kPlace.y());
  const auto height = [&](int x, int y) { return x == x0 && y == y0 ? 0.8 : 0.0; };
  EXPECT_TRUE(BlurredCellAt(height).is_covered);
}

// A picture that looks ahead, of a model whose points lie anywhere.
TEST(SpreadCells, EndsWhereAModelThatWentWrongSeesForEver) {
  SparseModel model = MakeFlatSurvey({1, 1, 1.6, 3.2});
  Rigid3d& pose = model.images[0].cam_from_world;
  const Eigen::Vector3d center = pose.OriginInSource();
  pose.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitX())) * pose.rotation;
  pose.translation = -(pose.rotation * center);
  Ground ground;
  ground.cell_side = 0.03;
  AddPoint({Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()}, &ground);
  FinishPoints(1, &ground);
  SpreadCells(MakeViews(model, 1e6), &ground);
  const size_t num_tiles = ground.LayerAt({Side::kTop, 0}).cells.Keys().size();
  EXPECT_GT(num_tiles, 100u);
  EXPECT_LT(num_tiles, 10000u);
}

}  // namespace
}  // namespace colmap_seapoint
