#include "feature/matching/flow_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

namespace colmap_seapoint {
namespace {

using Flow = std::function<std::array<double, 2>(double x, double y)>;

struct Scene {
  std::vector<SeaPoint> points1, points2;
  FeatureMatches matches;
  std::vector<bool> is_outlier;  // of the matches
};

SeaPoint At(double x, double y) {
  SeaPoint point;
  point.x = static_cast<float>(x);
  point.y = static_cast<float>(y);
  return point;
}

// Points all over a 1360 x 1024 picture that move as `flow` says, half a pixel of noise; a share
// of them lands anywhere instead. Indices of the two pictures are shuffled against each other.
Scene MakeScene(const Flow& flow, size_t count, double outlier_share, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> x(0, 1360), y(0, 1024), unit(0, 1), noise(-0.5, 0.5);
  Scene scene;
  std::vector<uint32_t> idx2(count);
  std::iota(idx2.begin(), idx2.end(), 0u);
  std::shuffle(idx2.begin(), idx2.end(), generator);
  scene.points2.resize(count);
  for (uint32_t i = 0; i < count; ++i) {
    scene.points1.push_back(At(x(generator), y(generator)));
    const SeaPoint& from = scene.points1.back();
    const bool outlier = unit(generator) < outlier_share;
    const auto to = flow(from.x, from.y);
    scene.points2[idx2[i]] = outlier ? At(x(generator), y(generator))
                                     : At(to[0] + noise(generator), to[1] + noise(generator));
    scene.matches.push_back({i, idx2[i]});
    scene.is_outlier.push_back(outlier);
  }
  return scene;
}

struct Quality {
  double precision = 0, recall = 0;
};

Quality Filter(const Scene& scene, double turn = 0,
               const FlowFilterOptions& options = FlowFilterOptions()) {
  const FeatureMatches kept =
      FilterFlow(scene.points1, scene.points2, scene.matches, turn, options);
  size_t num_good = 0, num_all_good = 0;
  for (size_t i = 0; i < scene.matches.size(); ++i) num_all_good += !scene.is_outlier[i];
  for (const FeatureMatch& match : kept) num_good += !scene.is_outlier[match.idx1];
  return {static_cast<double>(num_good) / static_cast<double>(std::max<size_t>(1, kept.size())),
          static_cast<double>(num_good) / static_cast<double>(num_all_good)};
}

Flow Translation(double dx, double dy) {
  return [=](double x, double y) { return std::array<double, 2>{x + dx, y + dy}; };
}

// Turns about the picture's middle, scales, then shifts.
Flow Similarity(double angle_deg, double scale, double dx, double dy) {
  const double c = scale * std::cos(angle_deg * M_PI / 180);
  const double s = scale * std::sin(angle_deg * M_PI / 180);
  return [=](double x, double y) {
    const double u = x - 680, v = y - 512;
    return std::array<double, 2>{680 + c * u - s * v + dx, 512 + s * u + c * v + dy};
  };
}

// What must stay of the true matches, and how pure it must be, with 0, 30 and 60 % outliers. Where
// a flow turns or swells, neighbours near its fixed point differ by more than the filter allows.
TEST(FlowFilterTest, FindsPlantedOutliers) {
  struct Case {
    const char* name;
    double turn_deg;  // as picture_turn.h finds it: the nearest of 32 steps
    Flow flow;
    std::array<double, 3> min_recall, min_precision;
  };
  const std::vector<Case> cases = {
      {"along the track", 0, Translation(260, 20), {1, 0.99, 0.93}, {1, 0.99, 0.97}},
      {"short step", 0, Translation(12, -3), {1, 0.99, 0.93}, {1, 0.99, 0.97}},
      {"climbing", 0, Similarity(0, 1.15, 90, 0), {0.94, 0.91, 0.80}, {1, 0.99, 0.97}},
      {"yaw in a turn", 22.5, Similarity(25, 1, 60, -40), {0.91, 0.88, 0.74}, {1, 0.98, 0.96}},
      {"the next strip, turned round",
       180,
       Similarity(180, 1, 30, 250),
       {0.89, 0.87, 0.76},
       {1, 0.95, 0.91}}};
  const std::array<double, 3> outlier_shares = {0, 0.3, 0.6};
  for (const Case& one : cases) {
    for (size_t i = 0; i < outlier_shares.size(); ++i) {
      const Scene scene = MakeScene(one.flow, 1500, outlier_shares[i], 3);
      const Quality quality = Filter(scene, one.turn_deg * M_PI / 180);
      EXPECT_GE(quality.recall, one.min_recall[i]) << one.name << " " << outlier_shares[i];
      EXPECT_GE(quality.precision, one.min_precision[i]) << one.name << " " << outlier_shares[i];
    }
  }
}

// Once the turn between the pictures is known, a neighbouring strip flown the other way, or at
// right angles, is filtered as well as the next picture: even when it is known to a step of 11
// degrees.
TEST(FlowFilterTest, KnownTurnMakesTurnedStripsEven) {
  for (const double angle_deg : {180.0, 90.0, -120.0}) {
    for (const double error_deg : {0.0, 5.0}) {
      const Scene scene = MakeScene(Similarity(angle_deg, 1, 30, 250), 1500, 0.6, 3);
      const Quality known = Filter(scene, (angle_deg + error_deg) * M_PI / 180);
      EXPECT_GE(known.recall, 0.92) << angle_deg << " " << error_deg;
      EXPECT_GE(known.precision, 0.96) << angle_deg << " " << error_deg;
    }
  }
}

TEST(FlowFilterTest, StationaryCameraKeepsItsMatches) {
  const Quality quality = Filter(MakeScene(Translation(0, 0), 800, 0.3, 4));
  EXPECT_GE(quality.recall, 0.99);
  EXPECT_GE(quality.precision, 0.99);
}

TEST(FlowFilterTest, DirectionAloneAndNormAloneAreEnoughToFail) {
  Scene scene = MakeScene(Translation(100, 0), 300, 0, 5);
  scene.points2[scene.matches[10].idx2] = At(scene.points1[10].x - 100, scene.points1[10].y);
  scene.points2[scene.matches[20].idx2] = At(scene.points1[20].x + 120, scene.points1[20].y);
  scene.points2[scene.matches[30].idx2] = At(scene.points1[30].x, scene.points1[30].y + 100);
  const FeatureMatches kept =
      FilterFlow(scene.points1, scene.points2, scene.matches, 0, FlowFilterOptions());
  EXPECT_EQ(kept.size(), 297u);
  for (const FeatureMatch& match : kept) {
    EXPECT_TRUE(match.idx1 != 10 && match.idx1 != 20 && match.idx1 != 30);
  }
}

// A match that ends on a corner beside the right one agrees with its neighbours in direction and
// norm; what gives it away is how even the flow around it is otherwise.
TEST(FlowFilterTest, DropsMatchesThatSlipped) {
  Scene scene = MakeScene(Similarity(3, 1.02, 250, 20), 1500, 0, 9);
  for (size_t i = 0; i < scene.matches.size(); i += 20) {
    scene.points2[scene.matches[i].idx2].x += i % 40 == 0 ? 5.0f : -3.0f;
    scene.points2[scene.matches[i].idx2].y += 4.0f;
    scene.is_outlier[i] = true;
  }
  const Quality quality = Filter(scene);
  EXPECT_GE(quality.recall, 0.98);
  EXPECT_GE(quality.precision, 0.995);
  FlowFilterOptions votes_only;
  votes_only.max_slip = 1000;
  EXPECT_LT(Filter(scene, 0, votes_only).precision, 0.96);
}

// Relief moves neighbours differently by many pixels: that is usual there, and stays.
TEST(FlowFilterTest, ReliefIsNoSlip) {
  const Flow rough = [](double x, double y) {
    const double height = std::sin(x / 15) * std::cos(y / 12);
    return std::array<double, 2>{x + 250 + 12 * height, y + 20};
  };
  const Quality quality = Filter(MakeScene(rough, 1500, 0, 10));
  EXPECT_GE(quality.recall, 0.9);
}

// The limits themselves: three neighbours, three votes needed.
TEST(FlowFilterTest, ThresholdsAreWhereTheySay) {
  FlowFilterOptions options;
  options.min_votes = 3;
  auto is_kept = [&](double dx, double dy) {
    std::vector<SeaPoint> points1, points2;
    FeatureMatches matches;
    for (uint32_t i = 0; i < 5; ++i) {
      points1.push_back(At(50 + 10 * i, 50));
      points2.push_back(At(50 + 10 * i + (i == 2 ? dx : 100.0), 50 + (i == 2 ? dy : 0.0)));
      matches.push_back({i, i});
    }
    const FeatureMatches kept = FilterFlow(points1, points2, matches, 0, options);
    return std::find(kept.begin(), kept.end(), FeatureMatch{2, 2}) != kept.end();
  };
  const double inside = 11.5 * M_PI / 180, outside = 12.5 * M_PI / 180;
  EXPECT_TRUE(is_kept(100 * std::cos(inside), 100 * std::sin(inside)));
  EXPECT_FALSE(is_kept(100 * std::cos(outside), 100 * std::sin(outside)));
  EXPECT_TRUE(is_kept(113, 0));   // 13 of 113: 11.5 %
  EXPECT_FALSE(is_kept(115, 0));  // 15 of 115: 13 %
  EXPECT_TRUE(is_kept(89, 0));
  EXPECT_FALSE(is_kept(87, 0));
}

TEST(FlowFilterTest, KeepsTheOrder) {
  const Scene scene = MakeScene(Translation(80, 10), 500, 0.4, 6);
  const FeatureMatches kept =
      FilterFlow(scene.points1, scene.points2, scene.matches, 0, FlowFilterOptions());
  ASSERT_GT(kept.size(), 200u);
  for (size_t i = 1; i < kept.size(); ++i) EXPECT_LT(kept[i - 1].idx1, kept[i].idx1);
}

TEST(FlowFilterTest, FewerMatchesThanNeighbours) {
  FlowFilterOptions options;
  ASSERT_EQ(options.min_votes, 4);
  for (size_t count = 0; count <= 17; ++count) {
    const Scene scene = MakeScene(Translation(50, 0), count, 0, 7);
    const size_t kept = FilterFlow(scene.points1, scene.points2, scene.matches, 0, options).size();
    EXPECT_EQ(kept, count > 4 ? count : 0) << count;
  }
  options.min_votes = 0;
  const Scene one = MakeScene(Translation(50, 0), 1, 0, 8);
  EXPECT_EQ(FilterFlow(one.points1, one.points2, one.matches, 0, options).size(), 1u);
}

}  // namespace
}  // namespace colmap_seapoint
