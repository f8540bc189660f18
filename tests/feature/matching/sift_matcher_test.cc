#include "feature/matching/sift_matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

using Descriptors = std::vector<SiftDescriptor>;

int Dot(const SiftDescriptor& a, const SiftDescriptor& b) {
  int dot = 0;
  for (size_t i = 0; i < 128; ++i) dot += int{a[i]} * int{b[i]};
  return dot;
}

double AngleOf(int dot) { return std::acos(std::min(1.0, dot / (512.0 * 512.0))); }

// The nearest of `all`, if it passes distance and ratio; the first of equals.
std::optional<uint32_t> Nearest(const SiftDescriptor& query, const Descriptors& all,
                                const SiftMatcherOptions& options) {
  std::vector<std::pair<int, uint32_t>> ranked;
  for (uint32_t j = 0; j < all.size(); ++j) ranked.emplace_back(-Dot(query, all[j]), j);
  std::sort(ranked.begin(), ranked.end());
  if (ranked.empty() || AngleOf(-ranked[0].first) > options.max_distance) return std::nullopt;
  if (ranked.size() > 1 &&
      AngleOf(-ranked[0].first) > options.max_ratio * AngleOf(-ranked[1].first)) {
    return std::nullopt;
  }
  return ranked[0].second;
}

FeatureMatches OracleMatches(const Descriptors& set1, const Descriptors& set2,
                             const SiftMatcherOptions& options) {
  FeatureMatches matches;
  for (uint32_t i = 0; i < set1.size(); ++i) {
    const auto j = Nearest(set1[i], set2, options);
    if (j && Nearest(set2[*j], set1, options) == i) matches.push_back({i, *j});
  }
  return matches;
}

SiftMatcherOptions Options(double max_distance, double max_ratio) {
  SiftMatcherOptions options;
  options.max_distance = max_distance;
  options.max_ratio = max_ratio;
  return options;
}

SiftDescriptor Scaled(const std::vector<double>& values) {
  double squared = 0;
  for (const double value : values) squared += value * value;
  SiftDescriptor descriptor;
  for (size_t i = 0; i < 128; ++i) {
    descriptor[i] =
        static_cast<uint8_t>(std::min(255.0, std::round(512 * values[i] / std::sqrt(squared))));
  }
  return descriptor;
}

// Descriptors with true partners at all distances, look-alikes and exact duplicates.
Descriptors MakeDescriptors(size_t count, size_t num_prototypes, unsigned seed) {
  std::mt19937 prototype_random(7), random(seed);
  std::vector<std::vector<double>> prototypes(num_prototypes, std::vector<double>(128));
  for (auto& prototype : prototypes) {
    for (double& value : prototype) value = static_cast<double>(prototype_random() % 1000);
  }
  Descriptors descriptors;
  for (size_t i = 0; i < count; ++i) {
    std::vector<double> values = prototypes[random() % num_prototypes];
    const double noise = static_cast<double>(random() % 4) * 150;
    for (double& value : values) value += noise * static_cast<double>(random() % 1000) / 1000;
    descriptors.push_back(Scaled(values));
  }
  return descriptors;
}

TEST(SiftMatcherTest, Distance) {
  SiftDescriptor a{}, b{};
  a.fill(45);  // a length of 509
  EXPECT_NEAR(SiftDistance(a, a), std::acos(45 * 45 * 128 / 262144.0), 1e-12);
  EXPECT_NEAR(SiftDistance(a, b), M_PI / 2, 1e-12);
  b.fill(255);
  EXPECT_EQ(SiftDistance(b, b), 0);
}

// Around the numbers of descriptors that go through the vectors together, and several times that.
TEST(SiftMatcherTest, EqualsBruteForce) {
  size_t total = 0;
  unsigned seed = 0;
  for (const auto& [count1, count2] : std::vector<std::pair<size_t, size_t>>{
           {1, 1}, {1, 70}, {70, 1}, {3, 7}, {4, 8}, {5, 9}, {31, 32}, {33, 65}, {150, 211}}) {
    const Descriptors set1 = MakeDescriptors(count1, 1 + count1 / 2, ++seed);
    const Descriptors set2 = MakeDescriptors(count2, 1 + count1 / 2, ++seed);
    for (const double max_ratio : {1.0, 0.95, 0.7, 0.1}) {
      for (const double max_distance : {1.5, 0.7, 0.4, 0.2, 0.0}) {
        const SiftMatcherOptions options = Options(max_distance, max_ratio);
        const FeatureMatches expected = OracleMatches(set1, set2, options);
        ForEachVectorTarget([&] { EXPECT_EQ(MatchSift(set1, set2, options), expected); });
        total += expected.size();
      }
    }
  }
  EXPECT_GT(total, 400u);
}

// The largest numbers there can be: no sum may overflow.
TEST(SiftMatcherTest, LargestNumbers) {
  SiftDescriptor full, half;
  full.fill(255);
  half.fill(128);
  ForEachVectorTarget([&] {
    EXPECT_EQ(MatchSift({half, full}, {full, half}, Options(1.5, 1)), (FeatureMatches{{1, 0}}));
  });
}

TEST(SiftMatcherTest, TiesGoToTheSmallerIndex) {
  const SiftDescriptor same = MakeDescriptors(1, 1, 1).front();
  ForEachVectorTarget([&] {
    EXPECT_EQ(MatchSift({same, same, same}, {same, same}, Options(0.4, 1)),
              (FeatureMatches{{0, 0}}));
  });
}

TEST(SiftMatcherTest, EmptySetsAndEmptyDescriptors) {
  const SiftDescriptor same = MakeDescriptors(1, 1, 1).front();
  const SiftMatcherOptions options;
  EXPECT_TRUE(MatchSift({}, {}, options).empty());
  EXPECT_TRUE(MatchSift({same}, {}, options).empty());
  EXPECT_TRUE(MatchSift({}, {same}, options).empty());
  EXPECT_TRUE(MatchSift({SiftDescriptor{}}, {SiftDescriptor{}}, Options(1.5, 1)).empty());
}

}  // namespace
}  // namespace colmap_seapoint
