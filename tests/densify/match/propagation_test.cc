#include "densify/match/propagation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace colmap_seapoint {
namespace {

constexpr int kNodesX = 160, kNodesY = 60, kDisparity = 10;
constexpr int kWidth = kNodesX * kMinNodeStep, kHeight = kNodesY * kMinNodeStep;

// Two rectified pictures of a wall at one disparity. Stripes of period 12 beneath fine noise: at
// 12 pixels too much it still correlates, but less.
struct Wall {
  RectPicture picture1, picture2;
  Gate gate{RectWindow{0, 0, kWidth, kHeight}, kMinNodeStep, Gate::kOpen};

  Wall() {
    std::mt19937 generator(3);
    GrayImage texture(kWidth + 100, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < texture.width; ++x) {
        const double stripes = 60 * std::sin(x * M_PI / 6) + 20 * std::sin(y * 0.7);
        texture.At(x, y) =
            static_cast<uint8_t>(128 + stripes + static_cast<int>(generator() % 80) - 40);
      }
    }
    for (RectPicture* picture : {&picture1, &picture2}) {
      picture->window = gate.Nodes().window;
      picture->gray = GrayImage(kWidth, kHeight);
      picture->gray.data.resize(picture->gray.data.size() + RectPicture::kSlack);
      const int shift = picture == &picture2 ? kDisparity : 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          picture->gray.At(x, y) = texture.At(x + 20 + shift, y);
        }
      }
    }
  }

  PartialDisparity Grow(const std::vector<Seed>& seeds, int max_generations = 1000) const {
    return Propagate(picture1, picture2, gate, seeds, {9, 0.5f, max_generations}, 2);
  }
};

// The seed at the middle of a node.
Seed SeedAt(int a, int b, double disparity) {
  return {(a + 0.5) * kMinNodeStep, (b + 0.5) * kMinNodeStep, disparity};
}

int CountNear(const PartialDisparity& partial, double disparity) {
  int count = 0;
  for (const float d : partial.disparity) count += std::abs(d - disparity) < 0.2;
  return count;
}

TEST(PropagationTest, OneSeedFillsTheWall) {
  const PartialDisparity partial = Wall().Grow({SeedAt(80, 30, kDisparity)});
  // All but the windows' margin, and what lies left of picture 2.
  const int first = (4 + kDisparity + 1 + 1) / kMinNodeStep;
  const int expected = (kNodesX - 1 - first) * (kNodesY - 2);
  EXPECT_NEAR(CountNear(partial, kDisparity), expected, 0.02 * expected);
  EXPECT_EQ(partial.num_failed_seeds, 0);
}

// Paper 2.6, Figure 12: where regions collide, the better match takes over, whoever came first.
TEST(PropagationTest, TheBetterRegionTakesOver) {
  const Wall wall;
  const Seed wrong1 = SeedAt(50, 20, kDisparity + 12), wrong2 = SeedAt(60, 40, kDisparity + 12);
  const PartialDisparity misled = wall.Grow({wrong1, wrong2});
  ASSERT_GT(CountNear(misled, kDisparity + 12), 2000);
  const PartialDisparity partial = wall.Grow({wrong1, wrong2, SeedAt(140, 30, kDisparity)});
  EXPECT_GT(CountNear(partial, kDisparity), 6500);
  EXPECT_LT(CountNear(partial, kDisparity + 12), 50);
}

TEST(PropagationTest, GrowthEndsAtTheLimit) {
  for (const int limit : {1, 5, 12}) {
    const PartialDisparity partial = Wall().Grow({SeedAt(80, 30, kDisparity)}, limit);
    EXPECT_EQ(CountNear(partial, kDisparity), 2 * limit * (limit + 1) + 1);
    for (int y = 0; y < kNodesY; ++y) {
      for (int x = 0; x < kNodesX; ++x) {
        const size_t node = static_cast<size_t>(y * kNodesX + x);
        const bool inside = std::abs(x - 80) + std::abs(y - 30) <= limit;
        ASSERT_EQ(partial.disparity[node] > 0, inside) << x << " " << y;
      }
    }
  }
}

TEST(PropagationTest, GatesHold) {
  Wall wall;
  for (int y = 0; y < kNodesY; ++y) {
    for (int x = 0; x < kNodesX; ++x) {
      const auto node = static_cast<size_t>(y * kNodesX + x);
      const auto cover = [&](float disparity) { wall.gate.Cover(node, {disparity, disparity}); };
      if (x >= 100 && x < 110) wall.gate.Close(node);
      if (y < 20) cover(kDisparity + 2);   // reconstructed already, about there
      if (y >= 45) cover(kDisparity + 9);  // something else is: this is new
    }
  }
  const PartialDisparity partial = wall.Grow({SeedAt(60, 30, kDisparity)});
  for (int y = 0; y < kNodesY; ++y) {
    for (int x = 0; x < kNodesX; ++x) {
      const float disparity = partial.disparity[static_cast<size_t>(y * kNodesX + x)];
      const bool beyond = y < 45 && x >= 100;  // the closed stripe runs through the open band
      if (y < 20 || (beyond && x < 110)) {
        ASSERT_EQ(disparity, 0) << x << " " << y;
      }
      if (y >= 22 && y < 54 && x >= 20 && x < 98) {
        ASSERT_NEAR(disparity, kDisparity, 0.2) << x << " " << y;
      }
    }
  }
  Gate gate({0, 0, 40, 4}, 4, Gate::kOpen);
  EXPECT_TRUE(gate.Admits(0, 1));
  EXPECT_FALSE(gate.Holds(0, 1));
  gate.Close(0);
  EXPECT_FALSE(gate.Admits(0, 1));
  EXPECT_FALSE(gate.Holds(0, 1));
  // A surface that runs from disparity 100 to 150 within the cell.
  gate.Cover(0, {100, 150});
  for (const float disparity : {92.1f, 100.0f, 125.0f, 159.9f}) {
    EXPECT_FALSE(gate.Admits(0, disparity));
    EXPECT_TRUE(gate.Holds(0, disparity));
  }
  for (const float disparity : {91.9f, 160.1f}) {
    EXPECT_TRUE(gate.Admits(0, disparity));
    EXPECT_FALSE(gate.Holds(0, disparity));
  }
}

// Windows that the samples, or the nodes, do not fill up.
TEST(SampleGridTest, EverySampleHasItsNode) {
  for (int step = 1; step <= 20; ++step) {
    for (int width = 1; width <= 50; ++width) {
      const int height = 1 + width * 7 % 30;
      const SampleGrid grid({0, 0, width, height}, step);
      const SampleGrid nodes({0, 0, width, height}, kMinNodeStep);
      for (int b = 0; b < grid.height; ++b) {
        for (int a = 0; a < grid.width; ++a) {
          const size_t node = nodes.IndexAt(grid.PixelX(a), grid.PixelY(b));
          ASSERT_LT(node, nodes.Size()) << step << " " << width;
          const int u = static_cast<int>(node) % nodes.width;
          const int v = static_cast<int>(node) / nodes.width;
          ASSERT_EQ(u, std::min(grid.PixelX(a) / kMinNodeStep, nodes.width - 1));
          ASSERT_EQ(v, std::min(grid.PixelY(b) / kMinNodeStep, nodes.height - 1));
        }
      }
    }
  }
}

TEST(PropagationTest, SeedsThatDoNotSpreadAreCounted) {
  const PartialDisparity partial = Wall().Grow(
      {SeedAt(80, 30, kDisparity + 6), SeedAt(60, 30, kDisparity + 6), SeedAt(-50, 30, 10)}, 10);
  EXPECT_EQ(partial.num_failed_seeds, 2);  // the third lies outside
}

}  // namespace
}  // namespace colmap_seapoint
