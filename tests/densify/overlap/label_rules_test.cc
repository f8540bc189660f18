// The label rules of the paper (2.5, 2.7) on exact worlds: what counts as overlap, what is new,
// what is tried again, and what an object hid from the pair before.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/densify/test_survey.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;
constexpr double kFocal = 210;
constexpr double kGsd = kDepth / kFocal;
constexpr int kWidth = 240, kHeight = 180;
constexpr double kAdvance = 0.22 * kWidth * kGsd;  // V and V + 2 share 56 %

Camera TestCamera() { return MildCamera(CameraModel::kOpenCV, kFocal, kWidth, kHeight); }

PartialDensificationOptions Sequential() {
  PartialDensificationOptions options;
  options.redundancy = "sequential";
  options.completion = false;
  return options;
}

// Four pictures that look straight down: the pairs are (0, 1) and (2, 3).
class FourPictures : public TestSurvey {
 public:
  explicit FourPictures(std::vector<Rectangle> objects = {})
      : TestSurvey(Ground(std::move(objects)), TestCamera()) {
    for (int i = 0; i < 4; ++i) {
      AddPicture(std::to_string(i) + ".jpg", StandAt(TestCamera(), {kAdvance * i, 0, 0}));
    }
    AddLandmarks(3600, {-1.3, 2.9}, {-1, 1});
  }

 private:
  static World Ground(std::vector<Rectangle> objects) {
    objects.push_back({{0, 0, kDepth}, {50, 0, 0}, {0, 50, 0}});
    return World(objects, NoiseTexture(42, 0.16, 4));
  }
};

// A part of the ground, seen from above.
struct Patch {
  double x_min, x_max, y_min, y_max;

  bool Holds(const Eigen::Vector3d& point, double margin = 0) const {
    return point.x() >= x_min + margin && point.x() <= x_max - margin &&
           point.y() >= y_min + margin && point.y() <= y_max - margin;
  }
};

// Share of the patch's squares, four GSD wide, that a cloud covers within two GSD.
double CoveredShare(const World& world, const PartialCloud& cloud, const Patch& patch) {
  const double side = 4 * kGsd;
  const auto covered = CoveredSquares(world, {cloud}, side, 2 * kGsd);
  int num_covered = 0, num_squares = 0;
  for (int a = static_cast<int>(std::ceil(patch.x_min / side)); (a + 1) * side <= patch.x_max;
       ++a) {
    for (int b = static_cast<int>(std::ceil(patch.y_min / side)); (b + 1) * side <= patch.y_max;
         ++b) {
      ++num_squares;
      num_covered += static_cast<int>(covered.count({a, b}));
    }
  }
  EXPECT_GT(num_squares, 15);
  return static_cast<double>(num_covered) / num_squares;
}

// A fish in front of the second picture only: what lies behind it has SeaPoints in V, but no seed
// and nothing to match.
constexpr Patch kBehindFish = {0.55, 0.95, -0.2, 0.2};

void SendFish(FourPictures* survey) {
  const auto pixel = survey->At(1).camera.ImgFromCam(survey->At(1).cam_from_world *
                                                     Eigen::Vector3d(0.75, 0, kDepth));
  survey->HideBehindFish(1, *pixel, 0.2 / kGsd);
}

// Whether a circle of `radius` pixels around the point's image lies in the picture.
bool SeesAround(const Viewpoint& viewpoint, const Eigen::Vector3d& point, double radius) {
  const auto pixel = viewpoint.camera.ImgFromCam(viewpoint.cam_from_world * point);
  return pixel && pixel->x() > radius && pixel->y() > radius && pixel->x() < kWidth - radius &&
         pixel->y() < kHeight - radius;
}

// Paper 2.7: REA where the neighbourhood lacks disparity, PA elsewhere.
TEST(LabelRulesTest, ProcessedOrToBeEvaluatedAgain) {
  FourPictures survey;
  SendFish(&survey);
  int num_rea = 0, num_pa = 0;
  Densify(&survey, Sequential(), 2, [&](const PairDebug& pair) {
    if (pair.previous_picture == nullptr) return;
    ASSERT_EQ(pair.previous_image_idx, 0);
    const double radius = pair.influence_radius0;
    const Patch around = {
        kBehindFish.x_min - 3 * radius * kGsd, kBehindFish.x_max + 3 * radius * kGsd,
        kBehindFish.y_min - 3 * radius * kGsd, kBehindFish.y_max + 3 * radius * kGsd};
    for (size_t i = 0; i < pair.previous_labels.size(); ++i) {
      const Eigen::Vector3d& point = survey.LandmarkOf(0, i);
      if (kBehindFish.Holds(point, radius * kGsd)) {
        EXPECT_EQ(pair.previous_labels[i], SeaPointLabel::kREA) << point.transpose();
        ++num_rea;
      } else if (!around.Holds(point) && SeesAround(survey.At(0), point, 3 * radius) &&
                 SeesAround(survey.At(1), point, 3 * radius)) {
        EXPECT_EQ(pair.previous_labels[i], SeaPointLabel::kPA) << point.transpose();
        ++num_pa;
      } else if (!SeesAround(survey.At(1), point, -2 * radius)) {  // V + 1 never saw it
        EXPECT_EQ(pair.previous_labels[i], SeaPointLabel::kREA) << point.transpose();
      }
    }
  });
  EXPECT_GT(num_rea, 20);
  EXPECT_GT(num_pa, 300);
}

// Paper 2.5: OA around the matches of PA points; REA where an REA point's match erases; NA by
// default.
TEST(LabelRulesTest, OverlapNewAndToBeEvaluatedAgain) {
  FourPictures survey;
  SendFish(&survey);
  int num_oa = 0, num_na = 0, num_rea = 0;
  const Outcome outcome = Densify(&survey, Sequential(), 2, [&](const PairDebug& pair) {
    if (pair.previous_picture == nullptr) return;
    ASSERT_EQ(pair.report.image_idx1, 2);
    const double radius = pair.influence_radius1;
    const Patch around = {
        kBehindFish.x_min - 3 * radius * kGsd, kBehindFish.x_max + 3 * radius * kGsd,
        kBehindFish.y_min - 3 * radius * kGsd, kBehindFish.y_max + 3 * radius * kGsd};
    for (size_t i = 0; i < pair.labels1.size(); ++i) {
      const Eigen::Vector3d& point = survey.LandmarkOf(2, i);
      const SeaPoint& pixel = (*pair.points1)[i];
      const bool marked = pair.mask.marked[pair.mask.grid.IndexOf(pixel.x, pixel.y)] != 0;
      if (!SeesAround(survey.At(0), point, -2 * radius)) {  // far beyond what V saw
        EXPECT_EQ(pair.labels1[i], SeaPointLabel::kNA) << point.transpose();
        EXPECT_FALSE(marked);
        ++num_na;
      } else if (kBehindFish.Holds(point, radius * kGsd)) {
        EXPECT_EQ(pair.labels1[i], SeaPointLabel::kREA) << point.transpose();
        EXPECT_FALSE(marked);
        ++num_rea;
      } else if (!around.Holds(point) && SeesAround(survey.At(0), point, 3 * radius) &&
                 SeesAround(survey.At(1), point, 3 * radius)) {
        EXPECT_EQ(pair.labels1[i], SeaPointLabel::kOA) << point.transpose();
        EXPECT_TRUE(marked);
        ++num_oa;
      }
    }
  });
  EXPECT_GT(num_oa, 300);
  EXPECT_GT(num_na, 300);
  EXPECT_GT(num_rea, 20);
  const PairReport& second = outcome.report.pairs.back();
  EXPECT_GE(second.num_oa, num_oa);
  EXPECT_GE(second.num_na, num_na);
  EXPECT_GE(second.num_rea, num_rea);
}

// The second chance: what failed in (V, V + 1) is reconstructed by (V + 2, V + 3), and only because
// it failed.
TEST(LabelRulesTest, WhatFailedIsRevivedInTheNextPair) {
  const Patch inside = {0.6, 0.9, -0.15, 0.15};
  FourPictures disturbed;
  SendFish(&disturbed);
  const Outcome with_fish = Densify(&disturbed, Sequential());
  ASSERT_EQ(with_fish.clouds.size(), 2u);
  EXPECT_LT(CoveredShare(disturbed.GetWorld(), with_fish.clouds[0], inside), 0.05);
  EXPECT_GT(CoveredShare(disturbed.GetWorld(), with_fish.clouds[1], inside), 0.95);

  FourPictures clear;
  const Outcome without_fish = Densify(&clear, Sequential());
  ASSERT_EQ(without_fish.clouds.size(), 2u);
  EXPECT_GT(CoveredShare(clear.GetWorld(), without_fish.clouds[0], inside), 0.95);
  EXPECT_EQ(CoveredShare(clear.GetWorld(), without_fish.clouds[1], inside), 0);
}

// The same with hardly a triangulated point in the model: the matches of REA SeaPoints are the
// seeds.
TEST(LabelRulesTest, RevivedSeaPointsAreSeeds) {
  FourPictures survey;
  SendFish(&survey);
  for (PosedImage& image : survey.MutableModel()->images) {
    for (uint64_t& id : image.point3D_ids) {
      const bool keep = id != kNoPoint3D && id % 20 == 0 &&
                        !kBehindFish.Holds(survey.Model().points3D.at(id).xyz, -0.1);
      if (!keep) id = kNoPoint3D;
    }
  }
  const Outcome outcome = Densify(&survey, Sequential());
  ASSERT_EQ(outcome.clouds.size(), 2u);
  EXPECT_GT(CoveredShare(survey.GetWorld(), outcome.clouds[1], {0.6, 0.9, -0.15, 0.15}), 0.9);
}

// A board upright on the ground hides what is behind it from V (at x = 0), where a box lies; V + 2
// (at x = 1) looks at it from the other side.
constexpr Patch kBox = {0.75, 0.95, -0.3, 0.3};
constexpr double kBoardTop = 1.3;

std::vector<Rectangle> BoardAndBox() {
  const double height = kDepth - kBoardTop;
  return {{{0.7, 0, kDepth - height / 2}, {0, 0, height / 2}, {0, 0.35, 0}},
          {{(kBox.x_min + kBox.x_max) / 2, 0, 1.9},
           {(kBox.x_max - kBox.x_min) / 2, 0, 0},
           {0, kBox.y_max, 0}}};
}

// Paper 2.7, interpair occlusions: no SeaPoint of V matches there, so it is no overlap.
TEST(LabelRulesTest, WhatWasHiddenIsReconstructedWhenItShows) {
  FourPictures survey(BoardAndBox());
  int num_on_box = 0;
  const Outcome outcome = Densify(&survey, Sequential(), 2, [&](const PairDebug& pair) {
    if (pair.previous_picture == nullptr) return;
    ASSERT_EQ(pair.report.image_idx1, 2);
    const double margin = pair.influence_radius1 * kGsd;
    for (size_t i = 0; i < pair.labels1.size(); ++i) {
      if (!kBox.Holds(survey.LandmarkOf(2, i), margin)) continue;
      EXPECT_EQ(pair.labels1[i], SeaPointLabel::kNA);
      ++num_on_box;
    }
  });
  EXPECT_GT(num_on_box, 10);
  ASSERT_EQ(outcome.clouds.size(), 2u);
  const Patch top = {kBox.x_min + 2 * kGsd, kBox.x_max - 2 * kGsd, -0.25, 0.25};
  EXPECT_EQ(CoveredShare(survey.GetWorld(), outcome.clouds[0], top), 0);
  EXPECT_GT(CoveredShare(survey.GetWorld(), outcome.clouds[1], top), 0.9);
  for (const PartialCloud& cloud : outcome.clouds) {
    int num_off = 0;
    for (const DensePoint& point : cloud.points) {
      num_off += survey.GetWorld().Distance(point.xyz.cast<double>()) > 4 * kGsd;
    }
    EXPECT_LT(num_off, 0.02 * static_cast<double>(cloud.points.size()));
  }
}

}  // namespace
}  // namespace colmap_seapoint
