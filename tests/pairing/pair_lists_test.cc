// Which pairs each matcher looks at.
#include "colmap_seapoint/pairing/pair_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "colmap_seapoint/pairing/spatial_pairs.h"

namespace colmap_seapoint {
namespace {

using Pairs = std::vector<ImagePair>;

std::vector<DatabaseImage> Images(const std::vector<std::string>& names) {
  std::vector<DatabaseImage> images;
  for (const std::string& name : names) {
    images.push_back({static_cast<uint32_t>(images.size() + 1), 1, name});
  }
  return images;
}

TEST(SequentialPairs, FollowTheNaturalOrder) {
  const auto images = Images({"img10.png", "img2.png", "img1.png", "img3.png"});
  EXPECT_EQ(SequentialPairs(images, 1), Pairs({{2, 3}, {2, 4}, {1, 4}}));
  EXPECT_EQ(SequentialPairs(images, 2), Pairs({{2, 3}, {3, 4}, {2, 4}, {1, 2}, {1, 4}}));
  EXPECT_EQ(SequentialPairs(images, 100).size(), 6u);
  EXPECT_TRUE(SequentialPairs(Images({"a.png"}), 5).empty());
  EXPECT_TRUE(SequentialPairs({}, 5).empty());
}

TEST(ExhaustivePairs, EachPairOnce) {
  std::vector<std::string> names;
  for (int i = 0; i < 120; ++i) names.push_back(std::to_string(i));
  const Pairs pairs = ExhaustivePairs(Images(names));
  const std::set<ImagePair> unique(pairs.begin(), pairs.end());
  EXPECT_EQ(pairs.size(), 120u * 119 / 2);
  EXPECT_EQ(unique.size(), pairs.size());
  for (const ImagePair& pair : pairs) EXPECT_LT(pair.first, pair.second);
}

std::vector<PlacedImage> RandomPlaces(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> side(-50, 50), height(-20, 20);
  std::vector<PlacedImage> images;
  for (int i = 0; i < count; ++i) {
    images.push_back({static_cast<uint32_t>((i * 37) % count + 1),
                      {side(random) + 5e5, side(random) + 4e6, height(random)}});
  }
  return images;
}

// By the definition.
std::set<ImagePair> BruteForce(const std::vector<PlacedImage>& images,
                               const SpatialPairOptions& options) {
  std::set<ImagePair> pairs;
  for (size_t i = 0; i < images.size(); ++i) {
    std::vector<std::pair<double, size_t>> others;
    for (size_t j = 0; j < images.size(); ++j) {
      Eigen::Vector3d difference = images[i].position - images[j].position;
      if (options.ignore_z) difference.z() = 0;
      if (j != i) others.emplace_back(difference.norm(), j);
    }
    std::sort(others.begin(), others.end());
    for (size_t k = 0; k < others.size(); ++k) {
      if (static_cast<int>(k) >= options.max_num_neighbors) break;
      if (others[k].first > options.max_distance) break;
      pairs.insert(std::minmax(images[i].image_id, images[others[k].second].image_id));
    }
  }
  return pairs;
}

TEST(SpatialPairs, AsByBruteForce) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const auto images = RandomPlaces(60 + static_cast<int>(seed) * 47, seed);
    for (const int max_num_neighbors : {1, 4, 20, 1000}) {
      for (const double max_distance : {3.0, 15.0, 1000.0}) {
        for (const bool ignore_z : {true, false}) {
          SpatialPairOptions options;
          options.max_num_neighbors = max_num_neighbors;
          options.max_distance = max_distance;
          options.ignore_z = ignore_z;
          const Pairs pairs = SpatialPairs(images, options);
          EXPECT_EQ(std::set<ImagePair>(pairs.begin(), pairs.end()), BruteForce(images, options));
          for (const ImagePair& pair : pairs) EXPECT_LT(pair.first, pair.second);
        }
      }
    }
  }
}

TEST(SpatialPairs, HeightCountsOnlyWhenAskedFor) {
  const std::vector<PlacedImage> images = {{1, {0, 0, 0}}, {2, {0, 1, 50}}, {3, {2, 0, 40}}};
  SpatialPairOptions options;
  options.max_num_neighbors = 1;
  EXPECT_EQ(SpatialPairs(images, options), Pairs({{1, 2}, {1, 3}}));
  options.ignore_z = false;
  EXPECT_EQ(SpatialPairs(images, options), Pairs({{1, 3}, {2, 3}}));
}

TEST(SpatialPairs, OddPlaces) {
  const SpatialPairOptions options;
  EXPECT_TRUE(SpatialPairs({}, options).empty());
  EXPECT_TRUE(SpatialPairs({{1, {0, 0, 0}}}, options).empty());
  // All at one place: each still has its neighbours, and no more than asked for.
  std::vector<PlacedImage> same;
  for (uint32_t i = 1; i <= 30; ++i) same.push_back({i, {1, 2, 3}});
  SpatialPairOptions few;
  few.max_num_neighbors = 3;
  const Pairs pairs = SpatialPairs(same, few);
  EXPECT_GE(pairs.size(), 30u * 3 / 2);
  EXPECT_LE(pairs.size(), 30u * 3);
}

}  // namespace
}  // namespace colmap_seapoint
