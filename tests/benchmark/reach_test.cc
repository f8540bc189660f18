#include "examples/benchmarks/densify/reach.h"

#include <gtest/gtest.h>

#include <cmath>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

using Cloud = std::vector<Eigen::Vector3f>;

// 20 x 20 points `spacing` apart from (x, 0, z) on.
void AddGrid(float x, float z, float spacing, Cloud* cloud) {
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 20; ++i) {
      cloud->push_back({x + spacing * static_cast<float>(i), spacing * static_cast<float>(j), z});
    }
  }
}

// Two fields that one camera sees: one a unit apart, ten below it; a coarse one, far below.
struct World {
  Cloud centers = {{0, 0, 10}};
  Cloud peer;
  World() {
    AddGrid(0, 0, 1, &peer);
    AddGrid(0, -500, 4, &peer);
  }
};

TEST(ReachTest, TheSameCloudIsReached) {
  const World world;
  const Reach reach = MeasureReach(world.peer, world.peer, world.centers);
  EXPECT_EQ(reach.peer.num_points, 400u);  // the far field is the farther half
  EXPECT_EQ(reach.cloud.num_points, 400u);
  EXPECT_EQ(reach.median_spacing, 1);
  EXPECT_GT(reach.range_limit, 28);
  EXPECT_LT(reach.range_limit, 510);
  EXPECT_EQ(reach.peer.within, std::vector<double>(3, 1));
  EXPECT_EQ(reach.cloud.within, std::vector<double>(3, 1));
}

TEST(ReachTest, DistancesCountInSpacingsOfThePeer) {
  const World world;
  Cloud above;
  AddGrid(0, 1.5f, 1, &above);
  const Reach shifted = MeasureReach(above, world.peer, world.centers);
  EXPECT_EQ(shifted.peer.within, (std::vector<double>{0, 1, 1}));
  EXPECT_EQ(shifted.cloud.within, (std::vector<double>{0, 1, 1}));
  // Of a peer twice as sparse the same distance is within one spacing.
  World sparse;
  for (Eigen::Vector3f& point : sparse.peer) point.head<2>() *= 2;
  for (Eigen::Vector3f& point : above) point.head<2>() *= 2;
  EXPECT_EQ(MeasureReach(above, sparse.peer, sparse.centers).peer.within,
            (std::vector<double>{1, 1, 1}));
}

TEST(ReachTest, EachWayForItself) {
  const World world;
  Cloud half;  // every second column, and as many points three units above the field
  for (size_t i = 0; i < 400; i += 2) half.push_back(world.peer[i]);
  for (size_t i = 0; i < 400; i += 2) half.push_back(world.peer[i] + Eigen::Vector3f(0, 0, 3));
  const Reach reach = MeasureReach(half, world.peer, world.centers);
  EXPECT_EQ(reach.peer.within, (std::vector<double>{1, 1, 1}));  // the next column is one away
  EXPECT_EQ(reach.cloud.within, (std::vector<double>{0.5, 0.5, 1}));
}

TEST(ReachTest, TwinsAndOutliersAreNoSpacing) {
  World world;
  world.peer.insert(world.peer.end(), world.peer.begin(), world.peer.begin() + 400);  // each twice
  for (size_t i = 0; i < 400; i += 43) {
    world.peer.push_back(world.peer[i] + Eigen::Vector3f(0, 0, 0.001f));  // and some nearly so
  }
  Cloud above;
  AddGrid(0, 1.5f, 1, &above);
  const Reach reach = MeasureReach(above, world.peer, world.centers);
  EXPECT_EQ(reach.median_spacing, 1);
  EXPECT_EQ(reach.cloud.within, (std::vector<double>{0, 1, 1}));
}

TEST(ReachTest, NothingToMeasure) {
  const World world;
  const Reach reach = MeasureReach({}, world.peer, world.centers);
  EXPECT_EQ(reach.peer.within, (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(reach.cloud.num_points, 0u);
  EXPECT_TRUE(std::isnan(reach.cloud.within[0]));
  EXPECT_THROW(MeasureReach(world.peer, {}, world.centers), Error);
  EXPECT_THROW(MeasureReach(world.peer, {{1, 2, 3}, {1, 2, 3}}, world.centers), Error);
}

TEST(ReachTest, TextTellsBothWays) {
  const World world;
  const std::string text = ReachText(MeasureReach({world.peer[0]}, world.peer, world.centers));
  EXPECT_NE(text.find("within 1 2 4 local spacings"), std::string::npos) << text;
  EXPECT_NE(text.find("the peer's 400 points: 0.0075 "), std::string::npos) << text;
  EXPECT_NE(text.find("the cloud's 1 points: 1.0000 1.0000 1.0000"), std::string::npos) << text;
}

}  // namespace
}  // namespace colmap_seapoint
