#include "densify/sequence/pair_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "tests/densify/sequence/survey_model.h"

namespace colmap_seapoint {
namespace {

// Overlap of pictures that advance by (100 - forward_percent) % of their length each.
std::function<double(int)> Advancing(int first, int forward_percent) {
  return [=](int position) {
    return std::max(0, 100 - (100 - forward_percent) * (position - first)) / 100.0;
  };
}

// The pairs that a whole sequence is made of, second picture always the next one.
std::vector<int> FirstPictures(int num_pictures, double max_overlap, int forward_percent) {
  std::vector<int> firsts;
  int first = 0;
  while (first + 1 < num_pictures) {
    firsts.push_back(first);
    first =
        SelectNextFirst(first + 1, num_pictures, max_overlap, Advancing(first, forward_percent));
  }
  return firsts;
}

TEST(SelectNextFirstTest, EightyPercent) {
  // V + 2 overlaps V by 60 %: not above the limit.
  EXPECT_EQ(FirstPictures(9, 0.6, 80), (std::vector<int>{0, 2, 4, 6, 7}));
  EXPECT_EQ(FirstPictures(9, 0.59, 80), (std::vector<int>{0, 3, 6, 7}));
}

TEST(SelectNextFirstTest, SixtyPercent) {
  // V + 2 overlaps by 20 %, but V + 3 not at all: the strip between would be lost.
  EXPECT_EQ(FirstPictures(6, 0.6, 60), (std::vector<int>{0, 1, 2, 3, 4}));
  // With 70 % V + 3 still touches V by 10 %.
  EXPECT_EQ(FirstPictures(7, 0.6, 70), (std::vector<int>{0, 2, 4, 5}));
}

TEST(SelectNextFirstTest, StationaryCameraIsPassedOver) {
  auto overlap = [](int position) { return position < 8 ? 0.99 : 0.5; };
  EXPECT_EQ(SelectNextFirst(1, 20, 0.6, overlap), 8);
  // Stationary to the end: the last two pictures.
  EXPECT_EQ(SelectNextFirst(1, 20, 0.6, [](int) { return 1.0; }), 18);
}

TEST(SelectNextFirstTest, EndOfTheSequence) {
  auto no_overlap = [](int) { return 0.0; };
  EXPECT_EQ(SelectNextFirst(9, 10, 0.6, no_overlap), 10);
  EXPECT_EQ(SelectNextFirst(8, 10, 0.6, no_overlap), 8);
  EXPECT_EQ(SelectNextFirst(1, 2, 0.6, no_overlap), 2);
}

TEST(SelectNextFirstTest, AsksForNoMoreThanItNeeds) {
  std::vector<int> asked;
  auto overlap = [&](int position) {
    asked.push_back(position);
    return position < 4 ? 0.8 : 0.4;
  };
  EXPECT_EQ(SelectNextFirst(1, 10, 0.6, overlap), 4);
  for (const int position : {2, 3, 4, 5}) {
    EXPECT_LE(std::count(asked.begin(), asked.end(), position), 1);
  }
  EXPECT_LE(*std::max_element(asked.begin(), asked.end()), 5);
}

// Whatever the overlaps are, every step goes on and the sequence ends with its last pair.
TEST(SelectNextFirstTest, AlwaysAdvancesAndAlwaysEnds) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 3000; ++trial) {
    const int num_pictures = 2 + static_cast<int>(generator() % 15);
    const double max_overlap = unit(generator);
    int first = 0, second = 1;
    int num_steps = 0;
    while (true) {
      second = std::min(num_pictures - 1, first + 1 + static_cast<int>(generator() % 4));
      const int next = SelectNextFirst(second, num_pictures, max_overlap, [&](int position) {
        EXPECT_TRUE(position > second && position < num_pictures);
        return unit(generator);
      });
      ASSERT_GT(next, first);
      ASSERT_LE(next, num_pictures);
      if (next == num_pictures) break;
      ASSERT_LE(next, num_pictures - 2);
      first = next;
      ASSERT_LT(++num_steps, num_pictures);
    }
    EXPECT_EQ(second, num_pictures - 1);
  }
}

// Paper 4: the simultaneous picture completes the pair, so the last picture can start one.
TEST(SelectNextStereoFirstTest, FirstBelowTheLimit) {
  EXPECT_EQ(SelectNextStereoFirst(0, 9, 0.6, Advancing(0, 80)), 2);
  EXPECT_EQ(SelectNextStereoFirst(0, 9, 0.59, Advancing(0, 80)), 3);
  EXPECT_EQ(SelectNextStereoFirst(0, 9, 0.6, Advancing(0, 50)), 1);
  EXPECT_EQ(SelectNextStereoFirst(7, 9, 0.6, [](int) { return 0.99; }), 8);
  EXPECT_EQ(SelectNextStereoFirst(2, 9, 0.6, [](int) { return 0.99; }), 8);
  EXPECT_EQ(SelectNextStereoFirst(8, 9, 0.6, [](int) { return 0.5; }), 9);
}

TEST(SelectNextStereoFirstTest, NoStripIsLostBetweenTwoPairs) {
  const auto jump = [](int position) { return position < 5 ? 0.8 : 0.05; };
  EXPECT_EQ(SelectNextStereoFirst(2, 9, 0.6, jump), 4);
  EXPECT_EQ(SelectNextStereoFirst(4, 9, 0.6, jump), 5);
  EXPECT_EQ(SelectNextStereoFirst(2, 6, 0.6, jump), 4);
}

// A model of `length` pictures on the track, the last `num_right` of them with a right one.
SparseModel ModelOf(int length, int num_right, StereoRig* rig) {
  SparseModel model;
  for (int i = 0; i < length + num_right; ++i) {
    PosedImage image;
    image.name = std::to_string(i);
    model.images.push_back(image);
    rig->is_right.push_back(i >= length);
    rig->right_of.push_back(i >= length - num_right && i < length ? i + num_right : -1);
  }
  return model;
}

std::vector<int> InOrder(const SparseModel& model) {
  std::vector<int> order(model.images.size());
  std::iota(order.begin(), order.end(), 0);
  return order;
}

TEST(SelectNextTest, SaysWhichPicturesItPassesOver) {
  StereoRig no_rig;
  const SparseModel model = ModelOf(9, 0, &no_rig);
  const Track track(model, InOrder(model), no_rig);
  const NextChoice next = SelectNext(track, 0, 1, 0.59, Advancing(0, 80));
  EXPECT_EQ(next.position, 3);
  EXPECT_EQ(next.passed_over, (std::vector<int>{2}));
  const NextChoice end = SelectNext(track, 0, 8, 0.6, Advancing(0, 80));
  EXPECT_FALSE(track.CanStartPair(end.position));
  EXPECT_TRUE(end.passed_over.empty());
}

TEST(SelectNextTest, SimultaneousPairsGoOnBehindTheirFirstPicture) {
  StereoRig rig;
  const SparseModel model = ModelOf(6, 6, &rig);
  const Track track(model, InOrder(model), rig);
  const NextChoice next = SelectNext(track, 0, track.RightOf(0), 0.5, Advancing(0, 80));
  EXPECT_EQ(next.position, 3);
  EXPECT_EQ(next.passed_over, (std::vector<int>{1, 2}));
}

TEST(SelectNextTest, TheLastPictureAddsItsSimultaneousPair) {
  StereoRig rig;
  const SparseModel model = ModelOf(6, 1, &rig);
  const Track track(model, InOrder(model), rig);
  const auto unasked = [](int) {
    ADD_FAILURE();
    return 0.0;
  };
  EXPECT_EQ(SelectNext(track, 4, 5, 0.6, unasked).position, 5);
}

SeaPoint At(double x, double y) {
  SeaPoint point;
  point.x = static_cast<float>(x);
  point.y = static_cast<float>(y);
  return point;
}

TEST(MeanMotionTest, MeanNormInSharesOfTheLongerSide) {
  const std::vector<SeaPoint> points1 = {At(10, 10), At(500, 300), At(3, 3)};
  const std::vector<SeaPoint> points2 = {At(500, 310), At(13, 14), At(9, 9)};
  const FeatureMatches matches = {{0, 1}, {1, 0}};  // 3 by 4, and 0 by 10
  EXPECT_NEAR(MeanMotion(points1, points2, matches, 1000), (5 + 10) / 2.0 / 1000, 1e-9);
  EXPECT_EQ(MeanMotion(points1, points2, {}, 1000), 0);
  EXPECT_EQ(MeanMotion(points1, points1, {{0, 0}, {1, 1}}, 1000), 0);
}

// Pictures that match as many times as they share points, by the projections of those.
class PlannedSource : public PictureSource {
 public:
  explicit PlannedSource(const SparseModel& model) : model_(model) {}

  Picture ReadPicture(int image_idx) override {
    if (image_idx == unreadable) throw Error("a.jpg", "is cut short", "copy it again");
    return {};
  }
  std::optional<Features> ReadSeaPoints(int image_idx) override {
    const PosedImage& image = At(image_idx);
    Features features;
    for (const uint64_t id : image.point3D_ids) {
      const auto pixel =
          SurveyModel::TestCamera().ImgFromCam(image.cam_from_world * model_.points3D.at(id).xyz);
      SeaPoint point;
      point.x = static_cast<float>(pixel->x());
      point.y = static_cast<float>(pixel->y());
      features.points.push_back(point);
    }
    return features;
  }
  Features FindSeaPoints(const Picture&) override { return {}; }
  std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) override {
    ++num_asked;
    FeatureMatches matches;
    if (!has_matches) return matches;
    const auto &ids1 = At(image_idx1).point3D_ids, &ids2 = At(image_idx2).point3D_ids;
    for (uint32_t a = 0; a < ids1.size(); ++a) {
      const auto found = std::find(ids2.begin(), ids2.end(), ids1[a]);
      if (found != ids2.end()) matches.push_back({a, static_cast<uint32_t>(found - ids2.begin())});
    }
    return matches;
  }
  FeatureMatches Match(const Features&, const Features&) override { return {}; }

  int unreadable = -1;
  bool has_matches = true;
  int num_asked = 0;

 private:
  const PosedImage& At(int image_idx) const {
    return model_.images[static_cast<size_t>(image_idx)];
  }

  const SparseModel& model_;
};

constexpr SecondRules kRules = {20, 0.02};

SparseModel AlongX(const std::vector<double>& x) {
  SurveyModel survey;
  for (size_t k = 0; k < x.size(); ++k) survey.AddAbove(std::to_string(k), x[k]);
  return survey.WithGround();
}

SecondChoice NextSecond(const SparseModel& model, int first, PlannedSource* source) {
  PictureCache pictures(source);
  return SelectSecond(model, Track(model, InOrder(model), {}), first, kRules, &pictures);
}

TEST(SelectSecondTest, TheNextOneOfAStrip) {
  const SparseModel model = AlongX({0, 0.4, 0.8, 1.2});
  PlannedSource source(model);
  EXPECT_EQ(NextSecond(model, 0, &source).position, 1);
  EXPECT_EQ(NextSecond(model, 2, &source).position, 3);
  source.unreadable = 1;
  EXPECT_EQ(NextSecond(model, 0, &source).position, 2);
  source.unreadable = 0;
  EXPECT_EQ(NextSecond(model, 0, &source).why_none, "the picture cannot be read");
}

// 30 pictures a second: the first one that is a degree of parallax away, without matching all
// those on the way.
TEST(SelectSecondTest, WalksOnAlongAVideo) {
  std::vector<double> x;
  for (int k = 0; k < 60; ++k) x.push_back(0.005 * k);
  const SparseModel model = AlongX(x);
  PlannedSource source(model);
  const int second = NextSecond(model, 0, &source).position;
  EXPECT_GE(second, 7);  // 0.035: a degree at a depth of 2
  EXPECT_LE(second, 10);
  EXPECT_LE(source.num_asked, 4);
}

TEST(SelectSecondTest, ACarrierThatHovers) {
  std::vector<double> x(40, 0.0);
  for (size_t k = 0; k < x.size(); ++k) x[k] = 1e-4 * static_cast<double>(k % 3);
  x.push_back(0.4);
  const SparseModel model = AlongX(x);
  PlannedSource source(model);
  EXPECT_EQ(NextSecond(model, 0, &source).position, 40);
  x.pop_back();
  const SparseModel never = AlongX(x);
  PlannedSource of_never(never);
  EXPECT_EQ(NextSecond(never, 0, &of_never).why_none,
            "the viewpoint hardly changes in the pictures that follow");
}

TEST(SelectSecondTest, EndsAfterFourThatDoNotMatch) {
  const SparseModel model = AlongX({0, 5, 5.1, 5.2, 5.3, 0.3});
  PlannedSource source(model);
  EXPECT_EQ(NextSecond(model, 0, &source).why_none, "no following picture matches it");
}

TEST(SelectBestSecondTest, TheFirstThatCanBeReadAndHasSeeds) {
  const SparseModel model = AlongX({0, 0.4, 0.8, 9});
  PlannedSource source(model);
  const Track track(model, InOrder(model), {});
  const auto choose = [&](int first, const std::vector<int>& ranked) {
    PictureCache pictures(&source);
    return SelectBestSecond(track, first, ranked, 20, &pictures);
  };
  EXPECT_EQ(choose(2, {0, 1}).position, 0) << "before the first one on the track";
  EXPECT_EQ(choose(2, {3, 1}).position, 1);
  EXPECT_EQ(choose(2, {3}).position, -1);
  EXPECT_NE(choose(2, {3}).why_none.find("too few matches"), std::string::npos);
  EXPECT_NE(choose(2, {}).why_none.find("no other picture sees"), std::string::npos);
  source.unreadable = 0;
  EXPECT_EQ(choose(2, {0, 1}).position, 1);
  EXPECT_EQ(choose(0, {1}).why_none, "the picture cannot be read");
  // Shared points of the model are seeds too.
  source.has_matches = false;
  EXPECT_EQ(choose(2, {1}).position, 1);
}

}  // namespace
}  // namespace colmap_seapoint
