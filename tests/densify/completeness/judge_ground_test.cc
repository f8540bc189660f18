#include "densify/completeness/judge_ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

const Eigen::Vector2d kPlace(0.1, 1.9);

// A strip that was blurred as a whole, over points at these heights, in cells' sides.
GroundCell BlurredCellAt(const std::function<double(int x, int y)>& height) {
  const SparseModel model = MakeFlatSurvey({1, 4, 1.6, 3.2});
  CompletenessInput input = FlatInput(model, [](const Eigen::Vector2d&) { return true; });
  for (PictureFacts& facts : input.facts) facts.is_bad = true;
  const double side = AssessCompleteness(input, {}, 1).ground.cell_side;
  const auto flat = input.for_each_point;
  input.for_each_point = [&](const auto& take) {
    flat([&](ConfidentPoint point) {
      const Eigen::Vector3d at = point.place.xyz / side;
      point.place.xyz.z() =
          side * height(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())));
      take(point);
    });
  };
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  const Ground& ground = result.ground;
  return *ground.layers.at({Side::kTop, 0})
              .cells.Find(ground.CellOf(kPlace.x()), ground.CellOf(kPlace.y()));
}

TEST(JudgeGround, BlurredPicturesCoverWhatTheyShowSmooth) {
  EXPECT_TRUE(BlurredCellAt([](int, int) { return 0.0; }).is_covered);
}

TEST(JudgeGround, BlurredPicturesDoNotCoverWhatTheyShowRough) {
  const GroundCell cell = BlurredCellAt([](int x, int y) { return 1.5 * ((7 * x + 3 * y) % 5); });
  EXPECT_FALSE(cell.is_covered);
  EXPECT_EQ(cell.cause, GapCause::kBadPicture);
}

// The surroundings tell it, and not a single cell that stands out.
TEST(JudgeGround, OneRoughCellInASmoothPlaceIsCovered) {
  const auto ground = [](double at) { return static_cast<int>(std::floor(at)); };
  const SparseModel model = MakeFlatSurvey({1, 4, 1.6, 3.2});
  const double side =
      AssessCompleteness(FlatInput(model, [](const Eigen::Vector2d&) { return true; }), {}, 1)
          .ground.cell_side;
  const int x0 = ground(kPlace.x() / side), y0 = ground(kPlace.y() / side);
  EXPECT_TRUE(
      BlurredCellAt([&](int x, int y) { return x == x0 && y == y0 ? 0.8 : 0.0; }).is_covered);
}

}  // namespace
}  // namespace colmap_seapoint
