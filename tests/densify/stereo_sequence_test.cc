// Sequences of a stereo rig (paper 4).
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <string>

#include "tests/densify/test_survey.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;
constexpr double kFocal = 210;
constexpr double kGsd = kDepth / kFocal;
constexpr int kNumFrames = 8;

// A rig that moves down the picture, a fifth of it a frame; its cameras stand 0.3 apart. image_idx
// of frame k: left 2 k, right 2 k + 1.
class StereoSurvey : public TestSurvey {
 public:
  StereoSurvey() : TestSurvey(Seabed(), TestCamera()) {
    std::mt19937 generator(4);
    std::uniform_real_distribution<double> jitter(-1, 1);
    for (int k = 0; k < kNumFrames; ++k) {
      const double x = 0.03 * jitter(generator), pitch = jitter(generator);
      const Viewpoint left = StandAt(TestCamera(), {x, 0.2 * 180 * kGsd * k, 0},
                                     {pitch, jitter(generator), 3 * jitter(generator)});
      Viewpoint right = left;
      right.cam_from_world.translation.x() -= 0.3;
      const std::string name = "/" + std::to_string(k + 1) + ".jpg";
      AddPicture("left" + name, left);
      AddPicture("right" + name, right);
    }
    AddLandmarks(3000, {-1.5, 1.8}, {-1.2, 3.8});
  }

  StereoRig Rig() const {
    std::map<std::string, std::string> names;
    for (int k = 1; k <= kNumFrames; ++k) {
      names[std::to_string(k) + ".jpg"] = std::to_string(k) + ".jpg";
    }
    return RigFromNames(Model(), "left", "right", names);
  }

 private:
  static Camera TestCamera() { return MildCamera(CameraModel::kOpenCV, kFocal, 240, 180); }
  static World Seabed() {
    return World(
        {{{0, 0, kDepth}, {50, 0, 0}, {0, 50, 0}}, {{0.2, 1.1, 1.75}, {0.2, 0, 0}, {0, 0.2, 0}}},
        NoiseTexture(42, 0.16, 4));
  }
};

PartialDensificationOptions SequenceOnly(const std::string& redundancy) {
  PartialDensificationOptions options;
  options.redundancy = redundancy;
  options.completion = false;
  return options;
}

TEST(StereoSequenceTest, SimultaneousPicturesAreThePair) {
  StereoSurvey survey;
  for (const std::string redundancy : {"sequential", "all"}) {
    const Outcome outcome = Densify(&survey, SequenceOnly(redundancy), 2, nullptr, survey.Rig());
    std::set<int> firsts;
    for (const PairReport& pair : outcome.report.pairs) {
      EXPECT_EQ(pair.image_idx1 % 2, 0) << "no right picture starts a pair";
      if (!pair.skipped.empty()) {
        EXPECT_EQ(pair.skipped, "overlaps too much with the pair before");
        continue;
      }
      firsts.insert(pair.image_idx1);
      EXPECT_EQ(pair.image_idx2, pair.image_idx1 + 1);
      EXPECT_NEAR(pair.baseline, 0.3, 1e-9);
    }
    // The first and the last frame start a pair; those that overlap by more than 60 % do not.
    EXPECT_EQ(firsts.count(0), 1u);
    EXPECT_EQ(firsts.count(2 * (kNumFrames - 1)), 1u);
    EXPECT_EQ(firsts.count(2), 0u);
    EXPECT_GE(firsts.size(), 3u);
    EXPECT_GE(ShareOnSurface(survey.GetWorld(), outcome, 4 * kGsd), 0.98);
  }
}

// What every frame's own pair gives in full is covered, with far fewer points.
TEST(StereoSequenceTest, PartialCoversWhatEveryFrameSees) {
  StereoSurvey survey;
  PartialDensificationOptions every = SequenceOnly("sequential");
  every.mode = "complete";
  every.max_overlap = 1;
  const Outcome all = Densify(&survey, every, 2, nullptr, survey.Rig());
  EXPECT_EQ(all.clouds.size(), static_cast<size_t>(kNumFrames));
  const Outcome partial = Densify(&survey, SequenceOnly("all"), 2, nullptr, survey.Rig());
  const auto seen = CoveredSquares(survey.GetWorld(), all.clouds, 4 * kGsd, 2 * kGsd);
  const auto covered = CoveredSquares(survey.GetWorld(), partial.clouds, 4 * kGsd, 2 * kGsd);
  size_t num_both = 0;
  for (const auto& square : seen) num_both += covered.count(square);
  EXPECT_GE(static_cast<double>(num_both), 0.97 * static_cast<double>(seen.size()));
  EXPECT_LT(static_cast<double>(partial.NumPoints()), 0.5 * static_cast<double>(all.NumPoints()));
}

TEST(StereoSequenceTest, InterpairIsLeftToLeft) {
  StereoSurvey survey;
  Densify(&survey, SequenceOnly("sequential"), 2, nullptr, survey.Rig());
  for (const auto& [pair, count] : survey.num_asked) {
    EXPECT_EQ(count, 1);
    const bool simultaneous = pair.first % 2 == 0 && pair.second == pair.first + 1;
    EXPECT_TRUE(simultaneous || (pair.first % 2 == 0 && pair.second % 2 == 0))
        << pair.first << ", " << pair.second;
  }
}

// The sequence rule takes over where there is no right picture to be had.
TEST(StereoSequenceTest, WithoutARightPictureTheNextLeftOneCompletesThePair) {
  for (const bool unreadable : {true, false}) {
    StereoSurvey survey;
    StereoRig rig = survey.Rig();
    if (unreadable) {
      survey.MakeUnreadable(1);
    } else {
      rig.right_of[0] = -1;
    }
    const Outcome outcome = Densify(&survey, SequenceOnly("all"), 2, nullptr, rig);
    const PairReport& pair = outcome.report.pairs.at(0);
    EXPECT_EQ(pair.image_idx1, 0);
    EXPECT_EQ(pair.image_idx2, 2);
    EXPECT_EQ(pair.skipped, "");
    EXPECT_GT(pair.num_points, 1000);
    EXPECT_EQ(outcome.report.left_out.size(), unreadable ? 1u : 0u);
    for (size_t i = 1; i < outcome.report.pairs.size(); ++i) {
      const PairReport& later = outcome.report.pairs[i];
      if (later.skipped.empty()) {
        EXPECT_EQ(later.image_idx2, later.image_idx1 + 1);
      }
    }
  }
}

TEST(StereoSequenceTest, UnreadableLeftPictureIsLeftOut) {
  StereoSurvey survey;
  survey.MakeUnreadable(0);
  const Outcome outcome = Densify(&survey, SequenceOnly("all"), 2, nullptr, survey.Rig());
  ASSERT_EQ(outcome.report.left_out.size(), 1u);
  EXPECT_EQ(outcome.report.pairs.at(0).skipped, "the picture cannot be read");
  EXPECT_EQ(outcome.report.pairs.at(1).image_idx1, 2);
  EXPECT_EQ(outcome.report.pairs.at(1).image_idx2, 3);
}

TEST(StereoSequenceTest, AnEmptyRigChangesNothing) {
  StereoSurvey survey;
  StereoRig nothing;
  nothing.right_of.assign(2 * kNumFrames, -1);
  nothing.is_right.assign(2 * kNumFrames, 0);
  const PartialDensificationOptions options;
  ExpectSameClouds(Densify(&survey, options), Densify(&survey, options, 2, nullptr, nothing));
}

TEST(StereoSequenceTest, SameCloudsWithAnyNumberOfThreads) {
  StereoSurvey survey;
  const PartialDensificationOptions options;
  ExpectSameClouds(Densify(&survey, options, 1, nullptr, survey.Rig()),
                   Densify(&survey, options, 5, nullptr, survey.Rig()));
}

}  // namespace
}  // namespace colmap_seapoint
