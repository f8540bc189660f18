#include "densify/completeness/self_check/check_by_hiding.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "densify/completeness/self_check/hidden_pictures.h"
#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

bool Everywhere(const Eigen::Vector2d&) { return true; }

CompletenessOptions Checked() {
  CompletenessOptions options;
  options.self_check = true;
  return options;
}

TEST(HiddenPictures, EveryPictureIsHiddenOnceInRunsOfThree) {
  const SparseModel model = MakeFlatSurvey();
  std::vector<int> times(model.images.size());
  for (int fold = 0; fold < kNumFolds; ++fold) {
    const std::vector<bool> is_hidden = HiddenInFold(model, fold);
    for (size_t i = 0; i < times.size(); ++i) times[i] += is_hidden[i] ? 1 : 0;
    for (size_t i = 0; i < times.size(); ++i) {
      EXPECT_EQ(is_hidden[i], static_cast<int>(i) / 3 % 4 == fold) << i;
    }
  }
  for (const int count : times) EXPECT_EQ(count, 1);
}

TEST(HiddenPictures, NothingOfThemIsLeft) {
  SparseModel model = MakeFlatSurvey();
  model.points3D[7].track = {{1, 0}, {2, 0}, {9, 0}};  // 1 to 3 are hidden
  model.points3D[8].track = {{4, 0}, {2, 0}, {9, 0}};
  const std::vector<bool> is_hidden = HiddenInFold(model, 0);
  const SparseModel rest = WithoutHidden(model, is_hidden);
  EXPECT_EQ(rest.points3D.count(7), 0u);
  EXPECT_EQ(rest.points3D.count(8), 1u);
  EXPECT_EQ(rest.images.size(), model.images.size() - 6);
  CompletenessInput full = FlatInput(model, Everywhere);
  full.lost = {"elsewhere.jpg"};
  const CompletenessInput input = InputWithoutHidden(full, rest, is_hidden);
  EXPECT_EQ(input.lost.size(), 7u);
  EXPECT_EQ(input.facts.size(), rest.images.size());
  int64_t num_left = 0, num_all = 0;
  full.for_each_point([&](const ConfidentPoint&) { ++num_all; });
  input.for_each_point([&](const ConfidentPoint& point) {
    ++num_left;
    for (const uint32_t i : point.pictures) EXPECT_FALSE(is_hidden[i]);
  });
  EXPECT_GT(num_left, num_all / 3);
  EXPECT_LT(num_left, num_all);
}

TEST(CheckByHiding, OnALevelSeabedTheMissingAreaIsToldRight) {
  const SparseModel model = MakeFlatSurvey({3, 12, 1.6, 3.2});
  const CompletenessResult result =
      AssessCompleteness(FlatInput(model, Everywhere), Checked(), 2);
  EXPECT_EQ(result.self_check.num_folds, kNumFolds);
  std::printf("hidden %g found %g false %g error %g\n", result.self_check.hidden_area, result.self_check.found_share, result.self_check.false_share, result.self_check.area_error);
}

}  // namespace
}  // namespace colmap_seapoint
