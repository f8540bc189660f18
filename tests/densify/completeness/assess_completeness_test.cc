#include "densify/completeness/assess_completeness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

const Eigen::Vector2d kHole(3.2, 4.0);
constexpr double kRadius = 0.8;
const double kDiscArea = 3.14159265358979 * kRadius * kRadius;

bool OutsideHole(const Eigen::Vector2d& place) { return (place - kHole).norm() > kRadius; }
bool Everywhere(const Eigen::Vector2d&) { return true; }

const Gap* GapAt(const CompletenessResult& result, const Eigen::Vector2d& place) {
  for (const Gap& gap : result.gaps) {
    if (AskedArea{gap.region.rings}.Contains(place)) return &gap;
  }
  return nullptr;
}

TEST(AssessCompleteness, FullCloudLeavesTheRimThatOnePictureSees) {
  const SparseModel model = MakeFlatSurvey();
  const CompletenessResult result = AssessCompleteness(FlatInput(model, Everywhere), {}, 2);
  const double once = AreaSeen(model, 1), twice = AreaSeen(model, 2);
  EXPECT_NEAR(result.gsd, kFlatGsd, 0.1 * kFlatGsd);
  EXPECT_NEAR(result.expected_area, once, 0.02 * once);
  EXPECT_NEAR(result.coverage[0].share, twice / once, 0.02);
  EXPECT_NEAR(AreaOf(result, GapCause::kImagedOnce), once - twice, 0.05 * once);
  EXPECT_LT(result.missing_area[static_cast<size_t>(GapCause::kViewsDisagree)], 0.005 * once);
  EXPECT_TRUE(result.ground.frame.IsWorld());
  EXPECT_LT(result.share_tolerance, 0.02);
}

TEST(AssessCompleteness, HoleThatGoodPicturesSeeIsWhereViewsDisagree) {
  const SparseModel model = MakeFlatSurvey();
  const CompletenessResult result = AssessCompleteness(FlatInput(model, OutsideHole), {}, 1);
  const Gap* gap = GapAt(result, kHole);
  ASSERT_NE(gap, nullptr);
  EXPECT_EQ(gap->region.cause, GapCause::kViewsDisagree);
  EXPECT_NEAR(gap->region.area, kDiscArea, 0.05 * kDiscArea);
  EXPECT_LT((gap->centroid - Eigen::Vector3d(kHole.x(), kHole.y(), 0)).norm(), 0.02);
  EXPECT_EQ(gap->pictures.size(), 5u);
}

TEST(AssessCompleteness, HoleWithoutTexture) {
  const SparseModel model = MakeFlatSurvey();
  CompletenessInput input = FlatInput(model, OutsideHole);
  for (size_t i = 0; i < model.images.size(); ++i) {
    PictureFacts& facts = input.facts[i];
    for (int b = 0; b < facts.height; ++b) {
      for (int a = 0; a < facts.width; ++a) {
        const Eigen::Vector3d center = model.images[i].cam_from_world.OriginInSource();
        const Eigen::Vector2d place =
            center.head<2>() + kFlatGsd * Eigen::Vector2d(16 * a + 8 - 160, 120 - 16 * b - 8);
        if (!OutsideHole(place)) facts.texture[static_cast<size_t>(b * facts.width + a)] = 3;
      }
    }
  }
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  const Gap* gap = GapAt(result, kHole);
  ASSERT_NE(gap, nullptr);
  EXPECT_EQ(gap->region.cause, GapCause::kNoTexture);
}

TEST(AssessCompleteness, BlurredPictures) {
  const SparseModel model = MakeFlatSurvey({1, 8, 1.6, 3.2});
  SparseModel good = model;
  const std::set<std::string> names = {"s0_03.jpg", "s0_04.jpg", "s0_05.jpg"};
  RemoveImages(names, &good);
  CompletenessInput input = FlatInput(good, Everywhere);
  input.model = &model;
  input.facts.assign(model.images.size(), TexturedFacts());
  for (size_t i = 0; i < model.images.size(); ++i) {
    input.facts[i].is_bad = names.count(model.images[i].name) > 0;
  }
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  constexpr double kWindow = 12;  // pixels: nearer to the edge nothing is matched in any picture
  const double missing = AreaWhere(model, [&](const Eigen::Vector3d& place) {
    return TimesSeen(model, place, kWindow) >= 2 && TimesSeen(good, place) < 2;
  });
  EXPECT_NEAR(AreaOf(result, GapCause::kBadPicture), missing, 0.05 * missing);
}

TEST(AssessCompleteness, LostPicturesBetweenTheirNeighbours) {
  SparseModel model = MakeFlatSurvey({1, 8, 1.6, 3.2});
  const SparseModel whole = model;
  RemoveImages({"s0_03.jpg", "s0_04.jpg", "s0_05.jpg"}, &model);
  CompletenessInput input = FlatInput(model, Everywhere);
  input.lost = {"s0_03.jpg", "s0_04.jpg", "s0_05.jpg"};
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  ASSERT_EQ(result.lost_runs.size(), 1u);
  const double missing = AreaSeen(whole, 2) - AreaSeen(model, 2);
  EXPECT_NEAR(AreaOf(result, GapCause::kPoseLost), missing, 0.05 * missing);
}

TEST(AssessCompleteness, NeverImagedInsideTheOutline) {
  SparseModel model = MakeFlatSurvey({1, 12, 1.6, 3.2});
  // Five in a row: of the 9.6 units between their neighbours' middles 4.8 are in no picture.
  std::set<std::string> gone;
  for (int k = 3; k < 8; ++k) gone.insert("s0_0" + std::to_string(k) + ".jpg");
  RemoveImages(gone, &model);
  const CompletenessResult result = AssessCompleteness(FlatInput(model, Everywhere), {}, 1);
  const Gap* gap = GapAt(result, {0, 8.8});
  ASSERT_NE(gap, nullptr);
  EXPECT_EQ(gap->region.cause, GapCause::kNeverImaged);
  // The disc's rounding at both open sides leaves some of 4.8 x 6.4.
  EXPECT_GT(gap->region.area, 0.8 * 4.8 * 6.4);
  EXPECT_LE(gap->region.area, 1.02 * 4.8 * 6.4);
}

TEST(AssessCompleteness, SmallParallax) {
  // Two pictures from nearly one place, and nothing else.
  const SparseModel model = MakeFlatSurvey({1, 2, 0.05, 3.2});
  CompletenessInput input = FlatInput(model, [](const Eigen::Vector2d& p) { return p.x() < 0; });
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  const Gap* gap = GapAt(result, {1.5, 0});
  ASSERT_NE(gap, nullptr);
  EXPECT_EQ(gap->region.cause, GapCause::kSmallParallax);
}

// A picture of the same ground from three times the height shows ground on all sides that nobody
// meant to measure.
TEST(AssessCompleteness, WhatOnePictureSeesFromAfarIsBackground) {
  SparseModel model = MakeFlatSurvey();
  const CompletenessResult before = AssessCompleteness(FlatInput(model, Everywhere), {}, 1);
  CompletenessInput input = FlatInput(model, Everywhere);
  PosedImage high = model.images[8];
  high.image_id = 99;
  high.name = "high.jpg";
  high.cam_from_world.translation.z() += 2 * kFlatAltitude;
  model.images.push_back(high);
  input.facts.push_back(TexturedFacts());
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  EXPECT_NEAR(result.expected_area, before.expected_area, 0.01 * before.expected_area);
  // What the outline or an asked area encloses is none.
  input.asked.rings = {{{-6, 3}, {-4, 3}, {-4, 5}, {-6, 5}}};
  const CompletenessResult asked = AssessCompleteness(input, {}, 1);
  EXPECT_NEAR(asked.missing_area[static_cast<size_t>(GapCause::kImagedOnce)], 4, 0.1);
}

// Half of the survey from twice the height: a quarter of the points is all that there can be.
TEST(AssessCompleteness, FromAfarNoMoreIsWantedThanThePicturesCanGive) {
  SparseModel model = MakeFlatSurvey({1, 16, 1.6, 3.2});
  for (size_t i = 10; i < model.images.size(); ++i) {
    model.images[i].cam_from_world.translation.z() += kFlatAltitude;
  }
  const auto is_near = [](const Eigen::Vector2d& p) { return p.y() < 16; };
  CompletenessInput input = FlatInput(model, [&](const Eigen::Vector2d& p) {
    const auto at = [](double x) { return std::lround(x / kFlatGsd + 1e6) % 2 == 0; };
    return is_near(p) || (at(p.x()) && at(p.y()));
  });
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  EXPECT_NEAR(result.coverage[0].area, AreaSeen(model, 2), 0.03 * AreaSeen(model, 2));
  CompletenessOptions strict;
  strict.spacing = kFlatGsd;
  EXPECT_LT(AssessCompleteness(input, strict, 1).coverage[0].area, 0.75 * AreaSeen(model, 2));
}

TEST(AssessCompleteness, AskedAreaIsAllThatCounts) {
  const SparseModel model = MakeFlatSurvey();
  CompletenessInput input = FlatInput(model, OutsideHole);
  // Half of it far outside of everything.
  input.asked.rings = {{{1, 2}, {5, 2}, {5, 6}, {1, 6}}, {{40, 40}, {42, 40}, {42, 42}, {40, 42}}};
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  EXPECT_NEAR(result.expected_area, 20, 0.2);
  EXPECT_NEAR(result.coverage[0].area, 16 - kDiscArea, 0.2);
  const Gap* outside = GapAt(result, {41, 41});
  ASSERT_NE(outside, nullptr);
  EXPECT_EQ(outside->region.cause, GapCause::kNeverImaged);
  EXPECT_EQ(result.gaps.size(), 2u);
}

TEST(AssessCompleteness, IdsStayWhenTheSurveyGrows) {
  const SparseModel model = MakeFlatSurvey();
  const CompletenessResult before = AssessCompleteness(FlatInput(model, OutsideHole), {}, 1);
  const Gap* hole = GapAt(before, kHole);
  ASSERT_NE(hole, nullptr);
  const SparseModel larger = MakeFlatSurvey({4, 6, 1.6, 3.2});
  CompletenessInput input = FlatInput(larger, OutsideHole);
  for (const Gap& gap : before.gaps) {
    input.former.push_back({gap.id, gap.region.layer, gap.outline});
  }
  input.last_id = 100;
  const CompletenessResult after = AssessCompleteness(input, {}, 1);
  const Gap* again = GapAt(after, kHole);
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(again->id, hole->id);
  for (const Gap& gap : after.gaps) EXPECT_TRUE(gap.id > 100 || gap.id <= before.last_id);
}

TEST(AssessCompleteness, SameForAnyNumberOfThreads) {
  const SparseModel model = MakeFlatSurvey();
  const CompletenessInput input = FlatInput(model, OutsideHole);
  const CompletenessResult one = AssessCompleteness(input, {}, 1);
  const CompletenessResult four = AssessCompleteness(input, {}, 4);
  EXPECT_EQ(one.expected_area, four.expected_area);
  EXPECT_EQ(one.missing_area, four.missing_area);
  ASSERT_EQ(one.gaps.size(), four.gaps.size());
  for (size_t i = 0; i < one.gaps.size(); ++i) {
    EXPECT_EQ(one.gaps[i].region.cells, four.gaps[i].region.cells);
    EXPECT_EQ(one.gaps[i].outline, four.gaps[i].outline);
  }
  for (size_t i = 0; i < one.records.size(); ++i) {
    EXPECT_EQ(one.records[i].causes, four.records[i].causes);
  }
}

TEST(AssessCompleteness, PicturesKnowTheirCells) {
  const SparseModel model = MakeFlatSurvey();
  const CompletenessResult result = AssessCompleteness(FlatInput(model, OutsideHole), {}, 1);
  // The first picture of the first strip: its outer half is seen once.
  const PictureRecord& first = result.records[0];
  EXPECT_NEAR(first.Share(CellState::kCovered) + first.Share(CellState::kNotCovered), 1, 0.02);
  EXPECT_GT(first.Share(CellState::kNotCovered), 0.1);
  const auto num_once = std::count(first.causes.begin(), first.causes.end(), GapCause::kImagedOnce);
  EXPECT_GT(num_once, 0);
}

TEST(AssessCompleteness, ThinnedCloudCoversAtACoarserSpacing) {
  const SparseModel model = MakeFlatSurvey({2, 6, 1.6, 3.2});
  // Every ninth point: three times the spacing.
  CompletenessInput input = FlatInput(model, [](const Eigen::Vector2d& p) {
    const auto at = [](double x) { return std::lround(x / kFlatGsd + 1e6) % 3 == 0; };
    return at(p.x()) && at(p.y());
  });
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  const double twice = AreaSeen(model, 2);
  EXPECT_LT(result.coverage[0].area, 0.02 * twice);
  EXPECT_LT(result.coverage[1].area, 0.7 * twice);
  EXPECT_NEAR(result.coverage[2].area, twice, 0.03 * twice);
}

TEST(AssessCompleteness, UnsurePointsCoverNothing) {
  const SparseModel model = MakeFlatSurvey({2, 6, 1.6, 3.2});
  CompletenessInput input = FlatInput(model, Everywhere);
  const auto sure = input.for_each_point;
  input.for_each_point = [&](const auto& take) {
    sure([&](ConfidentPoint p) {
      p.confidence = OutsideHole(p.place.xyz.head<2>()) ? 0.9f : 0.4f;
      take(p);
    });
  };
  EXPECT_NE(GapAt(AssessCompleteness(input, {}, 1), kHole), nullptr);
}

TEST(AssessCompleteness, CloudOfAnotherModel) {
  const SparseModel model = MakeFlatSurvey();
  CompletenessInput input = FlatInput(model, Everywhere);
  input.for_each_point = [](const auto& take) {
    for (int i = 0; i < 100; ++i) take({{{1e3 + i, 1e3, 0}, Eigen::Vector3d::UnitZ()}, 1});
  };
  input.num_points = 100;
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  EXPECT_LT(result.belonging_share, kMinBelonging);
  EXPECT_TRUE(result.gaps.empty());
}

TEST(AssessCompleteness, OnePictureAndStrayPoints) {
  const SparseModel model = MakeFlatSurvey({1, 1, 1.6, 3.2});
  CompletenessInput input;
  input.model = &model;
  input.num_points = 101;
  input.facts.assign(1, {});
  input.for_each_point = [](const auto& take) {
    for (int i = 0; i < 100; ++i) take({{{0.02 * i, 0, 0}, Eigen::Vector3d::Zero()}, 1});
    take({{{1e12, -1e12, 1e12}, Eigen::Vector3d::UnitZ()}, 1});  // far off
  };
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  EXPECT_GT(AreaOf(result, GapCause::kImagedOnce), 0.9 * 6.4 * 4.8);
  EXPECT_TRUE(std::isfinite(result.expected_area));
}

TEST(AssessCompleteness, WallIsItsOwnMap) {
  // The same survey turned upright: up is horizontal, ahead is the world's z.
  SparseModel model = MakeFlatSurvey();
  CompletenessInput input = FlatInput(model, OutsideHole);
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(0.5 * 3.14159265358979, Eigen::Vector3d::UnitX()));
  const auto flat = input.for_each_point;
  input.for_each_point = [&](const auto& take) {
    flat([&](const ConfidentPoint& p) {
      take({{turn * p.place.xyz, turn * p.place.normal}, p.confidence});
    });
  };
  for (PosedImage& image : model.images) {
    image.cam_from_world.rotation = image.cam_from_world.rotation * turn.conjugate();
  }
  input.frame_of = [&](const std::vector<Eigen::Vector3d>& sample) {
    EXPECT_FALSE(sample.empty());
    return PlanFrame{turn.conjugate().toRotationMatrix()};
  };
  const CompletenessResult result = AssessCompleteness(input, {}, 1);
  const auto gap = std::find_if(result.gaps.begin(), result.gaps.end(), [](const Gap& g) {
    return g.region.cause == GapCause::kViewsDisagree;
  });
  ASSERT_NE(gap, result.gaps.end());
  EXPECT_NEAR(gap->region.area, kDiscArea, 0.05 * kDiscArea);
}

}  // namespace
}  // namespace colmap_seapoint
