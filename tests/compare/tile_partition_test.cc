#include "colmap_seapoint/compare/tile_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace colmap_seapoint {
namespace {

std::vector<Eigen::Array2d> RandomPlaces(int count) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Array2d> places;
  for (int i = 0; i < count; ++i) places.emplace_back(10 * normal(random), normal(random));
  return places;
}

TEST(TilePartition, TilesAreDisjointFullAndOfTheSizeAskedFor) {
  const auto places = RandomPlaces(4000);
  const TilePartition partition(places, 10, 1000);
  std::vector<int> counts(static_cast<size_t>(partition.NumTiles()));
  for (const auto& place : places) {
    const int tile = partition.TileOf(place);
    ++counts[static_cast<size_t>(tile)];
    for (int other = 0; other < partition.NumTiles(); ++other) {
      EXPECT_EQ(partition.Box(other).Contains(place), other == tile);
    }
  }
  for (const int count : counts) {
    EXPECT_LE(count, 100);
    EXPECT_GE(count, 50);
  }
}

TEST(TilePartition, FarPlacesHaveATileToo) {
  const TilePartition partition(RandomPlaces(400), 1, 10);
  for (const double x : {-1e9, 1e9}) {
    const Eigen::Array2d place(x, -x);
    EXPECT_TRUE(partition.Box(partition.TileOf(place)).Contains(place));
  }
}

TEST(TilePartition, NeighboursAreAllThatComeNear) {
  const TilePartition partition(RandomPlaces(400), 1, 10);
  std::mt19937 random(5);
  for (const double reach : {0.0, 0.5, 5.0}) {
    for (int tile = 0; tile < partition.NumTiles(); ++tile) {
      const auto near = partition.Neighbours(tile, reach);
      const std::set<int> neighbours(near.begin(), near.end());
      EXPECT_EQ(neighbours.size(), near.size());
      EXPECT_EQ(neighbours.count(tile), 0u);
      // Places of the tile, and places within reach of them.
      for (const auto& place : RandomPlaces(400)) {
        if (partition.TileOf(place) != tile) continue;
        const double angle = 1e-3 * static_cast<double>(random() % 6284);
        const int there =
            partition.TileOf(place + reach * Eigen::Array2d(std::cos(angle), std::sin(angle)));
        EXPECT_TRUE(there == tile || neighbours.count(there) == 1);
      }
    }
  }
}

TEST(TilePartition, PlacesThatCannotBePartedAreOneTile) {
  const std::vector<Eigen::Array2d> places(1000, Eigen::Array2d(1, 2));
  EXPECT_EQ(TilePartition(places, 1, 10).NumTiles(), 1);
  std::vector<Eigen::Array2d> two = places;
  two.resize(1600, Eigen::Array2d(1, 3));
  EXPECT_EQ(TilePartition(two, 1, 10).NumTiles(), 2);
  std::reverse(two.begin(), two.end());
  EXPECT_EQ(TilePartition(two, 1, 10).NumTiles(), 2);
}

}  // namespace
}  // namespace colmap_seapoint
