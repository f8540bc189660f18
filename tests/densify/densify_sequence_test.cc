#include "densify/densify_sequence.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/densify/test_survey.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;
constexpr double kFocal = 210;
constexpr int kNumPictures = 9;

// A strip over a seabed with a step across and a block on it, 80 % forward overlap. Names whose
// natural order differs from both file order and alphabet: picture10 before picture9 in the
// alphabet, and the model lists them backwards.
class Strip : public TestSurvey {
 public:
  explicit Strip(int num_pictures = kNumPictures) : TestSurvey(Seabed(), TestCamera()) {
    std::mt19937 generator(4);
    std::uniform_real_distribution<double> jitter(-1, 1);
    std::vector<Viewpoint> viewpoints;
    for (int i = 0; i < num_pictures; ++i) {
      const double advance = 0.2 * 240 * kDepth / kFocal;  // a fifth of a picture
      const double y = 0.03 * jitter(generator), z = 0.03 * jitter(generator);
      const double pitch = 2 * jitter(generator), yaw = 2 * jitter(generator);
      viewpoints.push_back(
          StandAt(TestCamera(), {advance * i, y, z}, {pitch, yaw, 5 * jitter(generator)}));
    }
    for (int i = num_pictures - 1; i >= 0; --i) {
      AddPicture("picture" + std::to_string(5 + i) + ".jpg", viewpoints[static_cast<size_t>(i)]);
    }
    AddLandmarks(3000, {-1, 5}, {-1.2, 1.2});
  }

 private:
  static Camera TestCamera() { return MildCamera(CameraModel::kOpenCV, kFocal, 240, 180); }
  static World Seabed() {
    const NoiseTexture texture(42, 0.16, 4);
    return World({{{0, 0, kDepth}, {50, 0, 0}, {0, 50, 0}},
                  {{1.2, 0.1, 1.75}, {0.2, 0, 0}, {0, 0.2, 0}},
                  {{2.6, 0, 1.8}, {0.3, 0, 0}, {0, 5, 0}}},
                 texture);
  }
};

std::set<std::pair<int, int>> CoveredSquares(const Strip& strip, const Outcome& outcome) {
  const double gsd = kDepth / kFocal;
  return CoveredSquares(strip.GetWorld(), outcome.clouds, 4 * gsd, 2 * gsd);
}

double ShareOnSurface(const Strip& strip, const Outcome& outcome) {
  return ShareOnSurface(strip.GetWorld(), outcome, 4 * kDepth / kFocal);
}

Strip& TestStrip() {
  static Strip strip;
  return strip;
}

TEST(DensifySequenceTest, PartialCoversWhatCompleteCoversWithFewerPoints) {
  Strip& strip = TestStrip();
  PartialDensificationOptions options;
  const Outcome partial = Densify(&strip, options);
  options.mode = "complete";
  const Outcome complete = Densify(&strip, options);
  const auto partial_squares = CoveredSquares(strip, partial);
  const auto complete_squares = CoveredSquares(strip, complete);
  int64_t num_both = 0;
  for (const auto& square : complete_squares) {
    num_both += static_cast<int64_t>(partial_squares.count(square));
  }
  const double coverage =
      static_cast<double>(num_both) / static_cast<double>(complete_squares.size());
  const double points =
      static_cast<double>(partial.NumPoints()) / static_cast<double>(complete.NumPoints());
  EXPECT_GE(coverage, 0.98);
  EXPECT_LT(points, 0.35);
  EXPECT_GE(ShareOnSurface(strip, partial), 0.98);
  EXPECT_TRUE(partial.report.left_out.empty());
}

TEST(DensifySequenceTest, SequentialRedundancyWorksToo) {
  Strip& strip = TestStrip();
  PartialDensificationOptions options;
  options.redundancy = "sequential";
  const Outcome sequential = Densify(&strip, options);
  options.mode = "complete";
  const Outcome complete = Densify(&strip, options);
  const double coverage = static_cast<double>(CoveredSquares(strip, sequential).size()) /
                          static_cast<double>(CoveredSquares(strip, complete).size());
  EXPECT_GE(coverage, 0.9);
  EXPECT_LT(sequential.NumPoints(), 0.9 * static_cast<double>(complete.NumPoints()));
}

TEST(DensifySequenceTest, ReportAddsUp) {
  Strip& strip = TestStrip();
  const Outcome outcome = Densify(&strip, PartialDensificationOptions());
  EXPECT_EQ(outcome.report.num_points, outcome.NumPoints());
  std::map<std::pair<int, int>, int64_t> points_of_pair;
  for (const PartialCloud& cloud : outcome.clouds) {
    points_of_pair[{cloud.image_idx1, cloud.image_idx2}] +=
        static_cast<int64_t>(cloud.points.size());
  }
  int64_t sum = 0;
  std::map<std::pair<int, int>, int64_t> points_in_rows;
  for (const PairReport& pair : outcome.report.pairs) {
    sum += pair.num_points;
    if (pair.skipped.empty()) {
      points_in_rows[{pair.image_idx1, pair.image_idx2}] += pair.num_points;
      EXPECT_GT(pair.baseline, 0.1);
      EXPECT_GT(pair.num_seeds, 4);
    }
  }
  EXPECT_EQ(points_in_rows, points_of_pair);
  EXPECT_EQ(sum, outcome.report.num_points);
  // In the order of the names: the last image of the model is the first of the strip.
  EXPECT_EQ(outcome.report.pairs[0].image_idx1, kNumPictures - 1);
  EXPECT_EQ(outcome.report.pairs[0].overlap, 0);
  EXPECT_EQ(outcome.report.pairs[0].num_oa, 0);
}

// The one after the next shows just over 60 % of the first picture, with twice the baseline.
TEST(DensifySequenceTest, WideBaselineWhereCompletionComesBackForTheRest) {
  Strip& strip = TestStrip();
  PartialDensificationOptions options;
  EXPECT_EQ(Densify(&strip, options).report.pairs[0].image_idx2, kNumPictures - 3);
  options.completion = false;
  EXPECT_EQ(Densify(&strip, options).report.pairs[0].image_idx2, kNumPictures - 2);
  options.completion = true;
  options.redundancy = "sequential";
  EXPECT_EQ(Densify(&strip, options).report.pairs[0].image_idx2, kNumPictures - 2);
}

TEST(DensifySequenceTest, SameCloudsWithAnyNumberOfThreads) {
  Strip strip(4);
  const Outcome one = Densify(&strip, PartialDensificationOptions(), 1);
  const Outcome five = Densify(&strip, PartialDensificationOptions(), 5);
  ExpectSameClouds(one, five);
}

// What is stored is not worked out again, no pair is asked for twice, no picture decoded twice.
TEST(DensifySequenceTest, EveryPictureAndPairOnceInTheSequence) {
  for (const std::string redundancy : {"sequential", "all"}) {
    PartialDensificationOptions options;
    options.redundancy = redundancy;
    options.completion = false;
    Strip stored, found;
    found.stores_seapoints = found.stores_matches = false;
    const Outcome of_stored = Densify(&stored, options);
    const Outcome of_found = Densify(&found, options);
    for (const Strip* strip : {&stored, &found}) {
      EXPECT_GE(strip->num_asked.size(), 8u);
      for (const auto& [pair, count] : strip->num_asked) {
        EXPECT_EQ(count, 1) << pair.first << ", " << pair.second;
      }
      for (const auto& [image_idx, count] : strip->num_decoded) EXPECT_EQ(count, 1) << image_idx;
      EXPECT_EQ(strip->num_decoded.size(), static_cast<size_t>(kNumPictures));
    }
    EXPECT_EQ(stored.num_found, 0);
    EXPECT_EQ(stored.num_matched, 0);
    EXPECT_EQ(found.num_found, kNumPictures);
    EXPECT_EQ(found.num_matched, static_cast<int>(found.num_asked.size()));
    ExpectSameClouds(of_stored, of_found);
  }
}

// The same clouds with figures as without, and figures that fit the report.
TEST(DensifySequenceTest, DebugShowsWhatHappened) {
  for (const std::string redundancy : {"sequential", "all"}) {
    PartialDensificationOptions options;
    options.redundancy = redundancy;
    Strip strip(6);
    const Outcome plain = Densify(&strip, options);
    int num_shown = 0, num_with_previous = 0;
    int64_t num_normal = 0;
    const Outcome shown = Densify(&strip, options, 2, [&](const PairDebug& pair) {
      EXPECT_EQ(pair.partial->cloud.points.size(), static_cast<size_t>(pair.report.num_points));
      EXPECT_EQ(pair.view1.image_idx, pair.report.image_idx1);
      EXPECT_EQ(pair.view2.image_idx, pair.report.image_idx2);
      ++num_shown;
      num_normal += static_cast<int64_t>(pair.normal->cloud.points.size());
      if (pair.previous_picture == nullptr) return;
      ++num_with_previous;
      EXPECT_EQ(pair.report.pass, "sequence");
      EXPECT_EQ(pair.labels1.size(), pair.points1->size());
      EXPECT_EQ(pair.previous_labels.size(), pair.previous_points->size());
      EXPECT_GT(pair.interpair.size(), 100u);
      if (redundancy == "sequential") {
        EXPECT_EQ(pair.mask.OverlapRate(), pair.report.overlap);
      }
      EXPECT_EQ(pair.known.covered_range.empty(), redundancy == "sequential");
    });
    ExpectSameClouds(plain, shown);
    EXPECT_EQ(num_shown, static_cast<int>(shown.clouds.size()));
    EXPECT_GE(num_with_previous, 1);
    EXPECT_GT(num_normal, shown.NumPoints());
  }
}

TEST(DensifySequenceTest, UnreadablePictureIsLeftOutAndTheRestGoesOn) {
  Strip& strip = TestStrip();
  const Outcome whole = Densify(&strip, PartialDensificationOptions());
  for (const int position : {0, 1, 4, kNumPictures - 1}) {
    const int image_idx = kNumPictures - 1 - position;
    strip.MakeUnreadable(image_idx);
    const Outcome damaged = Densify(&strip, PartialDensificationOptions());
    strip.MakeUnreadable(-1);
    ASSERT_EQ(damaged.report.left_out.size(), 1u) << position;
    EXPECT_EQ(damaged.report.left_out[0].image_idx, image_idx);
    EXPECT_EQ(damaged.report.left_out[0].reason, "is cut short");
    for (const PairReport& pair : damaged.report.pairs) {
      // Another picture completes the pair instead.
      EXPECT_TRUE(pair.pass != "sequence" || pair.image_idx2 != image_idx) << position;
    }
    for (const PartialCloud& cloud : damaged.clouds) {
      EXPECT_NE(cloud.image_idx1, image_idx);
      EXPECT_NE(cloud.image_idx2, image_idx);
    }
    const double coverage = static_cast<double>(CoveredSquares(strip, damaged).size()) /
                            static_cast<double>(CoveredSquares(strip, whole).size());
    EXPECT_GT(coverage, 0.85) << position;
  }
}

// Of three pictures, the one that is not of the first pair has its say about it: the points behind
// a fish in it are less sure. A third picture that cannot be read says nothing.
TEST(DensifySequenceTest, AThirdPictureHasItsSay) {
  PartialDensificationOptions options;
  options.min_confidence = 0;
  Strip strip(3);
  const Outcome clear = Densify(&strip, options);
  const int idx1 = clear.clouds[0].image_idx1, idx2 = clear.clouds[0].image_idx2;
  const int third = 3 - idx1 - idx2;
  const Eigen::Vector2d center(120, 90);
  Strip with_fish(3);
  with_fish.HideBehindFish(third, center, 30);
  const Outcome hidden = Densify(&with_fish, options);
  ASSERT_EQ(hidden.clouds[0].image_idx1, idx1);
  ASSERT_EQ(hidden.clouds[0].image_idx2, idx2);

  const Viewpoint& view = strip.At(third);
  const auto mean_confidence = [&](const Outcome& outcome, bool behind) {
    double sum = 0, count = 0;
    for (const DensePoint& point : outcome.clouds[0].points) {
      const auto pixel = view.camera.ImgFromCam(view.cam_from_world * point.xyz.cast<double>());
      const double off = pixel ? (*pixel - center).lpNorm<Eigen::Infinity>() : 1e9;
      if (behind ? off > 20 : off < 50) continue;
      sum += static_cast<double>(point.confidence);
      ++count;
    }
    EXPECT_GT(count, 500) << behind;
    return sum / count;
  };
  strip.MakeUnreadable(third);
  const Outcome without = Densify(&strip, options);
  ASSERT_EQ(without.clouds.size(), 1u);
  EXPECT_EQ(without.report.left_out.size(), 1u);
  EXPECT_LT(mean_confidence(hidden, true), mean_confidence(without, true));
  EXPECT_LT(mean_confidence(without, true), mean_confidence(clear, true));
  EXPECT_LT(mean_confidence(without, false), mean_confidence(clear, false));
  EXPECT_EQ(mean_confidence(hidden, false), mean_confidence(clear, false));
}

TEST(DensifySequenceTest, NothingToDensify) {
  for (const int num_pictures : {0, 1}) {
    Strip strip(num_pictures);
    const Outcome outcome = Densify(&strip, PartialDensificationOptions());
    EXPECT_TRUE(outcome.clouds.empty());
    EXPECT_EQ(outcome.report.num_points, 0);
  }
}

TEST(DensifySequenceTest, WithoutMatchesEveryPictureIsSkippedWithAReason) {
  class NoMatches : public Strip {
   public:
    NoMatches() : Strip(4) {}
    std::optional<FeatureMatches> ReadMatches(int, int) override { return FeatureMatches(); }
  };
  NoMatches strip;
  PartialDensificationOptions options;
  options.completion = false;
  const Outcome outcome = Densify(&strip, options);
  EXPECT_TRUE(outcome.clouds.empty());
  ASSERT_EQ(outcome.report.pairs.size(), 3u);
  for (const PairReport& pair : outcome.report.pairs) {
    EXPECT_EQ(pair.skipped, "no following picture matches it");
    EXPECT_EQ(pair.image_idx2, -1);
  }
}

}  // namespace
}  // namespace colmap_seapoint
