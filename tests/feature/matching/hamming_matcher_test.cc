#include "feature/matching/hamming_matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bitset>
#include <optional>
#include <random>
#include <set>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

int BitsApart(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (int bit = 0; bit < 256; ++bit) {
    const size_t byte = static_cast<size_t>(bit / 8);
    distance += (a[byte] >> (bit % 8) & 1) != (b[byte] >> (bit % 8) & 1);
  }
  return distance;
}

// The nearest of `all`, if it passes distance and ratio; the first of equals.
std::optional<uint32_t> Nearest(const Descriptor& query, const std::vector<Descriptor>& all,
                                const HammingMatcherOptions& options) {
  std::vector<std::pair<int, uint32_t>> ranked;
  for (uint32_t j = 0; j < all.size(); ++j) ranked.emplace_back(BitsApart(query, all[j]), j);
  std::sort(ranked.begin(), ranked.end());
  if (ranked.empty() || ranked[0].first > options.max_distance) return std::nullopt;
  if (ranked.size() > 1 && ranked[0].first > options.max_ratio * ranked[1].first) {
    return std::nullopt;
  }
  return ranked[0].second;
}

FeatureMatches OracleMatches(const std::vector<Descriptor>& descriptors1,
                             const std::vector<Descriptor>& descriptors2,
                             const HammingMatcherOptions& options) {
  FeatureMatches matches;
  for (uint32_t i = 0; i < descriptors1.size(); ++i) {
    const auto j = Nearest(descriptors1[i], descriptors2, options);
    if (j && Nearest(descriptors2[*j], descriptors1, options) == i) matches.push_back({i, *j});
  }
  return matches;
}

Descriptor RandomDescriptor(std::mt19937* generator) {
  Descriptor descriptor;
  for (uint8_t& byte : descriptor) byte = static_cast<uint8_t>((*generator)());
  return descriptor;
}

Descriptor Flipped(Descriptor descriptor, int num_bits, std::mt19937* generator) {
  for (int i = 0; i < num_bits; ++i) {
    const size_t bit = (*generator)() % 256;
    descriptor[bit / 8] = static_cast<uint8_t>(descriptor[bit / 8] ^ (1u << (bit % 8)));
  }
  return descriptor;
}

// Descriptors with true partners at all distances, look-alikes and exact duplicates.
void MakeDescriptors(unsigned seed, size_t count1, size_t count2, std::vector<Descriptor>* set1,
                     std::vector<Descriptor>* set2) {
  std::mt19937 generator(seed);
  std::vector<Descriptor> prototypes;
  for (size_t i = 0; i < 1 + std::max(count1, count2) / 2; ++i) {
    prototypes.push_back(RandomDescriptor(&generator));
  }
  for (auto* set : {set1, set2}) {
    const size_t count = set == set1 ? count1 : count2;
    for (size_t i = 0; i < count; ++i) {
      const Descriptor& prototype = prototypes[generator() % prototypes.size()];
      set->push_back(Flipped(prototype, static_cast<int>(generator() % 4) * 20, &generator));
    }
  }
}

TEST(HammingMatcherTest, Distance) {
  std::mt19937 generator(1);
  Descriptor zeros{}, ones;
  ones.fill(0xFF);
  EXPECT_EQ(HammingDistance(zeros, zeros), 0);
  EXPECT_EQ(HammingDistance(zeros, ones), 256);
  for (int i = 0; i < 100; ++i) {
    const Descriptor a = RandomDescriptor(&generator), b = RandomDescriptor(&generator);
    EXPECT_EQ(HammingDistance(a, b), BitsApart(a, b));
  }
}

TEST(HammingMatcherTest, EqualsBruteForce) {
  size_t total = 0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    std::vector<Descriptor> set1, set2;
    MakeDescriptors(seed, 1 + seed * 5 % 97, 1 + seed * 11 % 61, &set1, &set2);
    for (const double max_ratio : {1.0, 0.8, 0.5}) {
      for (const int max_distance : {80, 30, 0, 256}) {
        HammingMatcherOptions options;
        options.max_distance = max_distance;
        options.max_ratio = max_ratio;
        const FeatureMatches expected = OracleMatches(set1, set2, options);
        ForEachVectorTarget(
            [&] { ASSERT_EQ(MatchHamming(set1, set2, options), expected) << seed; });
        total += expected.size();
      }
    }
  }
  EXPECT_GT(total, 1000u);
}

// One loop over all pairs, no cap, no vectors: every distance is entered on both sides.
FeatureMatches ScalarMatches(const std::vector<Descriptor>& descriptors1,
                             const std::vector<Descriptor>& descriptors2,
                             const HammingMatcherOptions& options) {
  struct Best {
    int distance = 257, second = 257;
    uint32_t idx = 0;
    void Enter(int candidate, uint32_t candidate_idx) {
      second = std::min(second, std::max(distance, candidate));
      if (candidate < distance) idx = candidate_idx;
      distance = std::min(distance, candidate);
    }
  };
  std::vector<Best> best1(descriptors1.size()), best2(descriptors2.size());
  for (uint32_t i = 0; i < best1.size(); ++i) {
    for (uint32_t j = 0; j < best2.size(); ++j) {
      const int distance = HammingDistance(descriptors1[i], descriptors2[j]);
      best1[i].Enter(distance, j);
      best2[j].Enter(distance, i);
    }
  }
  const auto passes = [&](const Best& best) {
    return best.distance <= options.max_distance &&
           best.distance <= options.max_ratio * best.second;
  };
  FeatureMatches matches;
  for (uint32_t i = 0; i < best1.size(); ++i) {
    const uint32_t j = best1[i].idx;
    if (passes(best1[i]) && best2[j].idx == i && passes(best2[j])) matches.push_back({i, j});
  }
  return matches;
}

// Around the numbers of descriptors that go through the vectors together, and several times that.
TEST(HammingMatcherTest, EqualsTheScalarLoopWithManyDescriptors) {
  size_t total = 0;
  unsigned seed = 100;
  for (const auto& [count1, count2] : std::vector<std::pair<size_t, size_t>>{
           {1, 300}, {300, 1}, {64, 65}, {127, 128}, {129, 255}, {40, 257}, {333, 1100}}) {
    std::vector<Descriptor> set1, set2;
    MakeDescriptors(++seed, count1, count2, &set1, &set2);
    for (const double max_ratio : {1.0, 0.95, 0.7, 0.1}) {
      for (const int max_distance : {256, 255, 128, 80, 1, 0}) {
        HammingMatcherOptions options;
        options.max_distance = max_distance;
        options.max_ratio = max_ratio;
        const FeatureMatches expected = ScalarMatches(set1, set2, options);
        ForEachVectorTarget([&] { EXPECT_EQ(MatchHamming(set1, set2, options), expected); });
        total += expected.size();
      }
    }
  }
  EXPECT_GT(total, 1000u);
}

// 255 and 256 bits apart: the distances do not fit the bytes in which they are compared.
TEST(HammingMatcherTest, AllBitsApart) {
  Descriptor zeros{}, ones, all_but_one;
  ones.fill(0xFF);
  all_but_one = ones;
  all_but_one[31] = 0x7F;
  size_t total = 0;
  for (const size_t count1 : {1, 2}) {
    const std::vector<Descriptor> set1(count1, zeros);
    for (const auto& set2 :
         {std::vector<Descriptor>{ones}, {ones, all_but_one}, {all_but_one, ones}, {ones, ones}}) {
      for (const int max_distance : {254, 255, 256}) {
        for (const double max_ratio : {1.0, 0.999, 0.99}) {
          HammingMatcherOptions options;
          options.max_distance = max_distance;
          options.max_ratio = max_ratio;
          const FeatureMatches expected = ScalarMatches(set1, set2, options);
          ForEachVectorTarget([&] { EXPECT_EQ(MatchHamming(set1, set2, options), expected); });
          total += expected.size();
        }
      }
    }
  }
  EXPECT_GT(total, 12u);  // 6 each of count1 without a ratio test, and some with it
}

TEST(HammingMatcherTest, OneToOneAndSorted) {
  std::vector<Descriptor> set1, set2;
  MakeDescriptors(77, 120, 90, &set1, &set2);
  HammingMatcherOptions options;
  const FeatureMatches matches = MatchHamming(set1, set2, options);
  std::set<uint32_t> used1, used2;
  for (size_t i = 0; i < matches.size(); ++i) {
    EXPECT_TRUE(used1.insert(matches[i].idx1).second);
    EXPECT_TRUE(used2.insert(matches[i].idx2).second);
    EXPECT_TRUE(i == 0 || matches[i - 1].idx1 < matches[i].idx1);
  }
  // Turned round, the same pairs.
  FeatureMatches back = MatchHamming(set2, set1, options);
  for (FeatureMatch& match : back) std::swap(match.idx1, match.idx2);
  std::sort(back.begin(), back.end(),
            [](const FeatureMatch& a, const FeatureMatch& b) { return a.idx1 < b.idx1; });
  EXPECT_EQ(back, matches);
}

TEST(HammingMatcherTest, TiesGoToTheSmallerIndex) {
  const Descriptor same{};
  const HammingMatcherOptions options;
  EXPECT_EQ(MatchHamming({same, same, same}, {same, same}, options), (FeatureMatches{{0, 0}}));
}

TEST(HammingMatcherTest, RatioHoldsInBothDirections) {
  Descriptor a{}, near{}, second{};
  near[0] = 0x0F;    // 4 bits from a
  second[1] = 0x1F;  // 5 bits from a
  HammingMatcherOptions options;
  options.max_ratio = 0.7;
  EXPECT_TRUE(MatchHamming({a}, {near, second}, options).empty());
  EXPECT_TRUE(MatchHamming({near, second}, {a}, options).empty());
  options.max_ratio = 0.9;
  EXPECT_EQ(MatchHamming({a}, {near, second}, options), (FeatureMatches{{0, 0}}));
  EXPECT_EQ(MatchHamming({near, second}, {a}, options), (FeatureMatches{{0, 0}}));
}

TEST(HammingMatcherTest, DistanceLimitIsInclusive) {
  Descriptor far{};
  for (size_t i = 0; i < 10; ++i) far[i] = 0xFF;
  HammingMatcherOptions options;
  options.max_distance = 80;
  EXPECT_EQ(MatchHamming({Descriptor{}}, {far}, options).size(), 1u);
  options.max_distance = 79;
  EXPECT_TRUE(MatchHamming({Descriptor{}}, {far}, options).empty());
}

TEST(HammingMatcherTest, EmptySets) {
  const HammingMatcherOptions options;
  EXPECT_TRUE(MatchHamming({}, {}, options).empty());
  EXPECT_TRUE(MatchHamming({Descriptor{}}, {}, options).empty());
  EXPECT_TRUE(MatchHamming({}, {Descriptor{}}, options).empty());
}

}  // namespace
}  // namespace colmap_seapoint
