#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "densify/completeness/gaps/closing_pass.h"
#include "densify/completeness/gaps/gap_ids.h"

namespace colmap_seapoint {
namespace {

std::vector<ClosingPass> RandomPasses(int count, uint32_t random) {
  const auto next = [&] {
    random = random * 1664525u + 1013904223u;
    return static_cast<double>(random >> 8) / (1 << 24);
  };
  std::vector<ClosingPass> passes(static_cast<size_t>(count));
  for (ClosingPass& pass : passes) {
    const Eigen::Vector3d begin(10 * next(), 10 * next(), 0);
    pass.corners = {begin, begin + Eigen::Vector3d(next(), next(), 0)};
  }
  return passes;
}

double BruteForce(const std::vector<ClosingPass>& passes) {
  std::vector<int> order(passes.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  double best = std::numeric_limits<double>::infinity();
  do {
    for (int turns = 0; turns < 1 << passes.size(); ++turns) {
      std::vector<RouteStop> route;
      for (const int p : order) route.push_back({p, (turns >> p & 1) != 0});
      best = std::min(best, TransitLength(passes, route));
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

bool HoldsAll(const std::vector<RouteStop>& route, size_t count) {
  std::set<int> in;
  for (const RouteStop& stop : route) in.insert(stop.pass);
  return in.size() == count && route.size() == count;
}

TEST(PlanRoute, ShortestOfAll) {
  EXPECT_TRUE(PlanRoute({}).empty());
  for (uint32_t seed = 1; seed < 6; ++seed) {
    const auto passes = RandomPasses(5, seed);
    const auto route = PlanRoute(passes);
    ASSERT_TRUE(HoldsAll(route, 5));
    EXPECT_NEAR(TransitLength(passes, route), BruteForce(passes), 1e-9);
  }
}

// The shortest of all by Held and Karp, written down backwards: what is left to do from each state.
double ShortestFrom(const std::vector<ClosingPass>& passes, size_t done, size_t state,
                    std::vector<double>* known) {
  const size_t n = passes.size();
  if (done + 1 == size_t{1} << n) return 0;
  double& best = (*known)[done * 2 * n + state];
  if (best >= 0) return best;
  best = std::numeric_limits<double>::infinity();
  const auto stop = [](size_t s) { return RouteStop{static_cast<int>(s / 2), s % 2 == 1}; };
  double shortest = best;
  for (size_t next = 0; next < 2 * n; ++next) {
    if (done >> (next / 2) & 1) continue;
    shortest =
        std::min(shortest, TransitLength(passes, {stop(state), stop(next)}) +
                               ShortestFrom(passes, done | size_t{1} << (next / 2), next, known));
  }
  return (*known)[done * 2 * n + state] = shortest;
}

TEST(PlanRoute, MorePassesThanAreTriedInEveryOrder) {
  constexpr size_t kPasses = 10;
  for (uint32_t seed = 1; seed < 9; ++seed) {
    const auto passes = RandomPasses(kPasses, seed);
    std::vector<double> known((size_t{1} << kPasses) * 2 * kPasses, -1);
    double shortest = std::numeric_limits<double>::infinity();
    for (size_t s = 0; s < 2 * kPasses; ++s) {
      shortest = std::min(shortest, ShortestFrom(passes, size_t{1} << (s / 2), s, &known));
    }
    const auto route = PlanRoute(passes);
    ASSERT_TRUE(HoldsAll(route, kPasses));
    EXPECT_LE(TransitLength(passes, route), 1.3 * shortest + 1e-9) << seed;
    EXPECT_GE(TransitLength(passes, route), shortest - 1e-9) << seed;
  }
}

TEST(PlanRoute, ManyPassesOnALine) {
  // The shortest way is known: along the line.
  std::vector<ClosingPass> passes(60);
  for (int i = 0; i < 60; ++i) {
    const double at = (i * 37) % 60;
    passes[static_cast<size_t>(i)].corners = {{at, 0, 0}, {at + 0.5, 0, 0}};
  }
  const auto route = PlanRoute(passes);
  ASSERT_TRUE(HoldsAll(route, 60));
  EXPECT_LE(TransitLength(passes, route), 1.3 * 59 * 0.5);
}

GapRegion Block(int x0, int y0, int nx, int ny) {
  GapRegion region;
  for (int y = y0; y < y0 + ny; ++y) {
    for (int x = x0; x < x0 + nx; ++x) region.cells.emplace_back(x, y);
  }
  return region;
}

TEST(PlanPass, LinesCoverTheGap) {
  Ground ground;
  ground.cell_side = 0.1;
  ground.LayerAt({Side::kTop, 0});
  const PassPlan plan{2, 2.5, 2, 0.7, 0.5};
  const ClosingPass narrow = PlanPass(ground, Block(0, 0, 10, 60), plan);
  EXPECT_EQ(narrow.num_lines, 1);
  EXPECT_NEAR(narrow.heading_deg, 0, 0.1);  // along its length, ahead
  EXPECT_NEAR(narrow.Begin().x(), 0.5, 1e-6);
  EXPECT_NEAR(narrow.Begin().y(), -1, 1e-6);
  EXPECT_NEAR(narrow.End().y(), 7, 1e-6);
  EXPECT_NEAR(narrow.Begin().z(), 2, 1e-6);
  EXPECT_EQ(narrow.tilt_deg, 0);
  EXPECT_EQ(narrow.num_pictures, 1 + 14);  // 8 units, 0.6 a picture
  const ClosingPass wide = PlanPass(ground, Block(0, 0, 50, 60), plan);
  // 5 units wide: lines 1.25 apart, whose outer ones show 1.25 more to either side.
  EXPECT_GE((wide.num_lines - 1) * 1.25 + 2.5, 5);
  EXPECT_EQ(wide.corners.size(), 2u * static_cast<size_t>(wide.num_lines));
}

TEST(AssignGapIds, LargestOverlapInherits) {
  const GapRegion a = Block(0, 0, 10, 10), b = Block(10, 0, 4, 10), c = Block(50, 50, 5, 5);
  const LayerKey top;
  // The former gap 7 held both a and b; 3 is gone.
  const std::vector<FormerGap> former = {{7, top, {{{0, 0}, {14, 0}, {14, 10}, {0, 10}}}},
                                         {3, top, {{{90, 0}, {91, 0}, {91, 1}, {90, 1}}}},
                                         {9, {Side::kLeft, 0}, {{{50, 50}, {60, 50}, {60, 60}}}}};
  const std::vector<int> ids =
      AssignGapIds({{top, &b.cells}, {top, &a.cells}, {top, &c.cells}}, 1, former, 12);
  EXPECT_EQ(ids, (std::vector<int>{13, 7, 14}));
}

}  // namespace
}  // namespace colmap_seapoint
