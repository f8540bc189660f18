#include "densify/match/plan_pair.h"

#include <gtest/gtest.h>

#include "densify/match/rectify_pair.h"
#include "tests/densify/pair_scene.h"

namespace colmap_seapoint {
namespace {

constexpr MatchOptions kOptions = {1, 9, 0.7f, 0.1, 0};

const PairScene& FlatScene() {
  const Camera camera = MakeCamera(CameraModel::kPinhole, 200, 240, 180);
  static const PairScene scene(FlatWorld(2), StandAt(camera, {-0.15, 0, 0}),
                               StandAt(camera, {0.15, 0, 0}));
  return scene;
}

PairInput Input() { return FlatScene().Input(PartialDensificationOptions(), 100); }

TEST(PlanPairTest, WindowsHoldBothPicturesOfAFlatScene) {
  const PairPlan plan = PlanPair(Input(), kOptions);
  ASSERT_EQ(plan.failure, "");
  EXPECT_EQ(plan.seeds.size(), 100u);
  EXPECT_TRUE(plan.covered_seeds.empty());
  for (const Seed& seed : plan.seeds) EXPECT_NEAR(seed.disparity, 30, 1e-6);  // f b / Z
  // A tenth and 16 pixels around the seeds', cut to whole pixels.
  EXPECT_NEAR(plan.disparities.min, 27 - 16, 1);
  EXPECT_NEAR(plan.disparities.max, 33 + 16, 1);
  EXPECT_EQ(plan.window1.width, 240);
  EXPECT_EQ(plan.window1.height, 180);
  EXPECT_EQ(plan.growth, 24);
  EXPECT_EQ(plan.node_step, kMinNodeStep);
  MatchOptions coarse = kOptions;
  coarse.step = 4;
  EXPECT_EQ(PlanPair(Input(), coarse).node_step, kMaxNodeStep);
}

// Only the right third is open: its window, widened by what correlation windows need.
TEST(PlanPairTest, WindowIsCutToWhatIsNew) {
  PairInput input = Input();
  CellGrid& grid = input.known.grid;
  input.known.closed.assign(grid.Size(), 0);
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    input.known.closed[cell] = grid.Center(cell).x() < 160;
  }
  const PairPlan plan = PlanPair(input, kOptions);
  ASSERT_EQ(plan.failure, "");
  EXPECT_LT(plan.seeds.size(), 60u);
  EXPECT_GE(plan.window1.width, 80);
  EXPECT_LE(plan.window1.width, 80 + 2 * grid.cell + plan.margin);

  input.mode = DensificationMode::kComplete;
  const PairPlan complete = PlanPair(input, kOptions);
  EXPECT_EQ(complete.seeds.size(), 100u);
  EXPECT_EQ(complete.window1.width, 240);
}

// Seeds on the surface that covers a cell say nothing new; one in front of it does.
TEST(PlanPairTest, SeedsOnCoveredSurfaceFallAway) {
  PairInput input = Input();
  input.known.covered_range.assign(input.known.grid.Size(), 0);
  for (size_t cell = 0; cell < input.known.grid.Size(); ++cell) {
    const Eigen::Vector2d center = input.known.grid.Center(cell);
    if (center.x() >= 120) continue;
    input.known.covered_range[cell] =
        static_cast<float>(2 * input.view1.camera.CamFromImg(center)->homogeneous().norm());
  }
  const size_t num_open = PlanPair(input, kOptions).seeds.size();
  EXPECT_GT(num_open, 30u);
  EXPECT_LT(num_open, 70u);
  input.seeds.push_back({{60, 90}, {20, 90}});  // disparity 40
  const PairPlan plan = PlanPair(input, kOptions);
  EXPECT_EQ(plan.seeds.size(), num_open + 1);
  ASSERT_EQ(plan.covered_seeds.size(), 1u);
  EXPECT_NEAR(plan.covered_seeds[0].disparity, 40, 1e-9);
}

TEST(PlanPairTest, FailuresSayWhy) {
  PairInput input = Input();
  input.view2 = input.view1;
  EXPECT_EQ(PlanPair(input, kOptions).failure, "the cameras coincide");
  input = Input();
  input.seeds.resize(4);
  EXPECT_EQ(PlanPair(input, kOptions).failure, "too few seeds in areas that are new");
}

TEST(RectifyPairTest, GateTellsClosedOpenAndCovered) {
  PairInput input = Input();
  CellGrid& grid = input.known.grid;
  input.known.closed.assign(grid.Size(), 0);
  input.known.covered_range.assign(grid.Size(), 0);
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    const Eigen::Vector2d center = grid.Center(cell);
    if (center.x() < 80) input.known.closed[cell] = 1;
    if (center.x() > 160) {
      input.known.covered_range[cell] =
          static_cast<float>(2 * input.view1.camera.CamFromImg(center)->homogeneous().norm());
    }
  }
  const PairPlan plan = PlanPair(input, kOptions);
  ASSERT_EQ(plan.failure, "");
  const RectifiedPair pair = RectifyPair(input, plan, 2);
  const SampleGrid& nodes = pair.gate.Nodes();
  int num_closed = 0, num_open = 0, num_covered = 0;
  for (size_t node = 0; node < nodes.Size(); ++node) {
    if (pair.cell_of_node[node] < 0) {
      EXPECT_EQ(pair.gate[node], Gate::kClosed);
      continue;
    }
    const double x = grid.Center(static_cast<size_t>(pair.cell_of_node[node])).x();
    if (x < 80) {
      EXPECT_EQ(pair.gate[node], Gate::kClosed);
      ++num_closed;
    } else if (x > 160) {
      EXPECT_EQ(pair.gate[node], Gate::kCovered);
      EXPECT_TRUE(pair.gate.Holds(node, 30));
      EXPECT_FALSE(pair.gate.Holds(node, 30 - 6.5f));  // 4 and a 25th beside the cell's range
      EXPECT_FALSE(pair.gate.Holds(node, 30 + 6.5f));
      ++num_covered;
    } else {
      EXPECT_EQ(pair.gate[node], Gate::kOpen);
      ++num_open;
    }
  }
  EXPECT_GT(num_closed, 0);
  EXPECT_GT(num_open, 500);
  EXPECT_GT(num_covered, 0);
}

}  // namespace
}  // namespace colmap_seapoint
