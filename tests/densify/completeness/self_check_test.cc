#include <gtest/gtest.h>

#include <cmath>

#include "densify/completeness/self_check/check_by_hiding.h"
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

TEST(HiddenPictures, EveryPictureIsHiddenOnce) {
  const SparseModel model = MakeFlatSurvey();
  std::vector<int> times(model.images.size());
  for (int fold = 0; fold < kNumFolds; ++fold) {
    const std::vector<bool> is_hidden = HiddenInFold(model, fold);
    for (size_t i = 0; i < times.size(); ++i) times[i] += is_hidden[i] ? 1 : 0;
    for (size_t i = 0; i < times.size(); ++i) {
      EXPECT_EQ(is_hidden[i], static_cast<int>(i) % 4 == fold) << i;
    }
  }
  for (const int count : times) EXPECT_EQ(count, 1);
}

TEST(HiddenPictures, NothingOfThemIsLeft) {
  SparseModel model = MakeFlatSurvey();
  model.points3D[7].track = {{1, 0}, {5, 0}, {2, 0}};  // 1, 5, 9, ... are hidden
  model.points3D[8].track = {{1, 0}, {2, 0}, {3, 0}};
  const std::vector<bool> is_hidden = HiddenInFold(model, 0);
  const SparseModel rest = WithoutHidden(model, is_hidden);
  EXPECT_EQ(rest.points3D.count(7), 0u);
  EXPECT_EQ(rest.points3D.count(8), 1u);
  EXPECT_EQ(rest.images.size(), model.images.size() - 5);
  CompletenessInput full = FlatInput(model, Everywhere);
  full.lost = {"elsewhere.jpg"};
  const CompletenessInput input = InputWithoutHidden(full, rest, is_hidden);
  EXPECT_EQ(input.lost.size(), 6u);
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

constexpr FlatSurveyOptions kSurvey = {2, 8, 1.6, 3.2};

TEST(CheckByHiding, OnALevelSeabedTheMissingAreaIsToldRight) {
  const SparseModel model = MakeFlatSurvey(kSurvey);
  const CompletenessResult result = AssessCompleteness(FlatInput(model, Everywhere), Checked(), 2);
  EXPECT_EQ(result.self_check.num_folds, kNumFolds);
  EXPECT_GT(result.self_check.hidden_area, 0.5 * result.coverage[0].area);
  EXPECT_GT(result.self_check.found_share, 0.99);
  EXPECT_LT(result.self_check.false_share, 0.01);
  EXPECT_LT(result.self_check.area_error, 0.01);
}

// Heights that a gap's surroundings do not tell: the missing area is larger than it is said.
TEST(CheckByHiding, WhatCannotBeForetoldWidensTheTolerance) {
  const SparseModel model = MakeFlatSurvey(kSurvey);
  CompletenessInput input = FlatInput(model, Everywhere);
  const auto level = input.for_each_point;
  input.for_each_point = [level](const auto& take) {
    level([&](ConfidentPoint point) {
      point.place.xyz.z() =
          0.1 * std::sin(4 * point.place.xyz.x()) * std::sin(4 * point.place.xyz.y());
      take(point);
    });
  };
  const CompletenessResult checked = AssessCompleteness(input, Checked(), 2);
  const CompletenessResult unchecked = AssessCompleteness(input, {}, 2);
  EXPECT_GT(checked.self_check.area_error, 0.02);
  EXPECT_GT(checked.share_tolerance, 1.5 * unchecked.share_tolerance);
  EXPECT_EQ(checked.coverage[0].share, unchecked.coverage[0].share);
  EXPECT_EQ(unchecked.self_check.num_folds, 0);
}

TEST(CheckByHiding, AFewPicturesAreNotHidden) {
  const SparseModel model = MakeFlatSurvey({1, 7, 1.6, 3.2});
  const CompletenessResult result = AssessCompleteness(FlatInput(model, Everywhere), Checked(), 1);
  EXPECT_EQ(result.self_check.num_folds, 0);
}

}  // namespace
}  // namespace colmap_seapoint
