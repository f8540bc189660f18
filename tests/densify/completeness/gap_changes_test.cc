// What became of the gaps of the report before, when their survey grows, and when it moves.
#include "colmap_seapoint/gaps/gap_changes.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/base/similarity3.h"
#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

using Place = Eigen::Vector2d;
constexpr double kRadius = 0.8;
const Place kFirst(1.5, 2), kSecond(4.8, 2), kThird(3.2, 6);

bool IsIn(const Place& p, const Place& hole, double radius = kRadius) {
  return (p - hole).norm() < radius;
}

class GapChanges : public testing::Test {
 protected:
  CompletenessResult Assess(const KeepPoint& keep) {
    CompletenessInput input = FlatInput(model_, keep);
    input.former = former_.gaps;
    input.last_id = former_.last_id;
    return AssessCompleteness(input, {}, 2);
  }
  void Remember(const CompletenessResult& result) {
    former_ = {};
    for (const Gap& gap : result.gaps) {
      former_.gaps.push_back({gap.id, gap.region.layer, gap.outline});
      former_.areas.push_back(gap.region.area);
    }
    for (const PosedImage& image : model_.images) {
      former_.pictures.push_back({image.name, image.cam_from_world});
    }
    former_.last_id = result.last_id;
  }
  static int IdAt(const CompletenessResult& result, const Place& place) {
    for (const Gap& gap : result.gaps) {
      if ((gap.centroid.head<2>() - place).norm() < 0.3) return gap.id;
    }
    return 0;
  }
  GapChange Of(const CompletenessResult& result, int id) const {
    for (const GapChange& change : ChangesOf(former_, result)) {
      if (change.id == id) return change;
    }
    return {};
  }

  SparseModel model_ = MakeFlatSurvey();
  FormerReport former_;
};

bool AllHoles(const Place& p) { return !IsIn(p, kFirst) && !IsIn(p, kSecond) && !IsIn(p, kThird); }

TEST_F(GapChanges, ClosedSmallerAndAsBefore) {
  const CompletenessResult before = Assess(AllHoles);
  const int first = IdAt(before, kFirst), second = IdAt(before, kSecond),
            third = IdAt(before, kThird);
  ASSERT_TRUE(first > 0 && second > 0 && third > 0);
  Remember(before);
  EXPECT_EQ(ChangesText(ChangesOf(former_, before)), "");
  const CompletenessResult after =
      Assess([](const Place& p) { return !IsIn(p, kSecond, 0.6 * kRadius) && !IsIn(p, kThird); });
  EXPECT_EQ(Of(after, first).fate, GapFate::kClosed);
  EXPECT_EQ(Of(after, first).area_now, 0);
  EXPECT_NEAR(Of(after, first).area_before, 3.14159 * kRadius * kRadius, 0.1);
  EXPECT_EQ(Of(after, second).fate, GapFate::kSmaller);
  EXPECT_NEAR(Of(after, second).area_now, 0.36 * 3.14159 * kRadius * kRadius, 0.1);
  EXPECT_EQ(Of(after, third).fate, GapFate::kAsBefore);
  EXPECT_EQ(ChangesText(ChangesOf(former_, after)), "of the gaps of the report before " +
                                                        std::to_string(first) + " is closed, " +
                                                        std::to_string(second) + " is smaller");
}

// Two gaps that have become one are one id, and neither is closed.
TEST_F(GapChanges, JoinedIsNotClosed) {
  const Place left(0.8, 4), right(5.6, 4);  // too far apart for one pass
  const CompletenessResult before =
      Assess([&](const Place& p) { return !IsIn(p, left, 0.7) && !IsIn(p, right, 0.6); });
  const int id_left = IdAt(before, left), id_right = IdAt(before, right);
  ASSERT_TRUE(id_left > 0 && id_right > 0 && id_left != id_right);
  Remember(before);
  const CompletenessResult after = Assess(
      [](const Place& p) { return !(p.x() > 0 && p.x() < 6.3 && p.y() > 3.2 && p.y() < 4.8); });
  EXPECT_EQ(Of(after, id_left).fate, GapFate::kLarger);
  EXPECT_EQ(Of(after, id_right).fate, GapFate::kJoined);
  EXPECT_EQ(Of(after, id_right).joined_to, id_left);
}

// Brought into metres, turned, and reported on again: the gaps are the same ones.
TEST_F(GapChanges, MovesWithTheModel) {
  const CompletenessResult before = Assess(AllHoles);
  Remember(before);
  Similarity3d move;
  move.scale = 2.5;
  move.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.2, 1).normalized());
  move.translation = {30, -20, 10};
  SparseModel moved = model_;
  TransformModel(move, &moved);
  FormerReport former = former_;
  MoveToModel(moved, &former);
  ASSERT_EQ(former.gaps.size(), former_.gaps.size());
  for (size_t i = 0; i < former.gaps.size(); ++i) {
    EXPECT_NEAR(former.areas[i], 6.25 * former_.areas[i], 1e-9);
    for (size_t k = 0; k < former.gaps[i].rings[0].size(); ++k) {
      EXPECT_LT((former.gaps[i].rings[0][k] - move * former_.gaps[i].rings[0][k]).norm(), 1e-9);
    }
  }
}

TEST_F(GapChanges, AnotherModelHasNoneOfThem) {
  Remember(Assess(AllHoles));
  ASSERT_FALSE(former_.gaps.empty());
  FormerReport same = former_;
  MoveToModel(model_, &same);
  EXPECT_EQ(FormerReportText(same), FormerReportText(former_));
  SparseModel other = model_;
  for (size_t i = 0; i < other.images.size(); i += 2) {
    other.images[i].cam_from_world.translation += Eigen::Vector3d(0, 4, 0);
  }
  FormerReport former = former_;
  MoveToModel(other, &former);
  EXPECT_TRUE(former.gaps.empty() && former.areas.empty());
  EXPECT_EQ(former.last_id, former_.last_id);
  for (PosedImage& image : other.images) image.name = "another_" + image.name;
  former = former_;
  MoveToModel(other, &former);
  EXPECT_TRUE(former.gaps.empty());
}

}  // namespace
}  // namespace colmap_seapoint
