#include "feature/detector/adaptive_threshold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "tests/feature/detector/detector_oracle.h"

namespace colmap_seapoint {
namespace {

int CountAtLeast(const std::vector<float>& measures, float threshold) {
  return static_cast<int>(std::count_if(measures.begin(), measures.end(),
                                        [&](float measure) { return measure >= threshold; }));
}

float LowEndOfBin(double bin) { return static_cast<float>(bin * 255 / 256); }

void Append(int count, double low, double high, std::vector<float>* measures) {
  for (int i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 0;
    measures->push_back(static_cast<float>(low + share * (high - low)));
  }
}

// Figure 5: 2202 points down to bin 98, 3793 with bin 97; 2502 at bin 186 of the second histogram.
std::vector<float> FigureFive() {
  std::vector<float> measures;
  Append(2201, LowEndOfBin(98.01), 254.9, &measures);
  measures.push_back(255);
  const double low = LowEndOfBin(97.05), high = LowEndOfBin(97.95), bin = (high - low) / 256;
  measures.push_back(static_cast<float>(low));
  Append(1290, low + 0.5 * bin, low + 185.9 * bin, &measures);
  Append(10, low + 186.2 * bin, low + 186.8 * bin, &measures);
  Append(289, low + 187.2 * bin, low + 255.5 * bin, &measures);
  measures.push_back(static_cast<float>(high));
  Append(9000, 0, LowEndOfBin(96.99), &measures);
  return measures;
}

TEST(AdaptiveThresholdTest, FigureFiveOfThePaper) {
  const std::vector<float> measures = FigureFive();
  ASSERT_EQ(CountAtLeast(measures, LowEndOfBin(98)), 2202);
  ASSERT_EQ(CountAtLeast(measures, LowEndOfBin(97)), 3793);
  const AdaptiveThreshold result = FindAdaptiveThreshold(measures, 2500, 3000);
  EXPECT_EQ(result.status, ThresholdStatus::kConverged);
  EXPECT_EQ(result.num_rounds, 2);
  EXPECT_EQ(result.count, 2502);
  EXPECT_EQ(CountAtLeast(measures, result.threshold), 2502);
  EXPECT_GE(result.threshold, LowEndOfBin(97));
  EXPECT_LT(result.threshold, LowEndOfBin(98));
}

TEST(AdaptiveThresholdTest, OneRoundWhenABinEndsInTheInterval) {
  std::vector<float> measures;
  Append(100, 200, 255, &measures);
  Append(100, 0, 50, &measures);
  const AdaptiveThreshold result = FindAdaptiveThreshold(measures, 90, 110);
  EXPECT_EQ(result.status, ThresholdStatus::kConverged);
  EXPECT_EQ(result.num_rounds, 1);
  EXPECT_GE(result.count, 90);
  EXPECT_LE(result.count, 110);
}

TEST(AdaptiveThresholdTest, RecursesAsDeepAsTheClusterAsks) {
  // Each scale is 300 times finer than the one before: each needs a histogram of its own.
  std::vector<float> measures = {255};
  double width = 1;
  for (int scale = 0; scale < 4; ++scale) {
    Append(40, 0, width, &measures);
    width /= 300;
  }
  for (const auto& [target, rounds] :
       std::vector<std::pair<int, int>>{{30, 2}, {70, 3}, {110, 4}}) {
    const AdaptiveThreshold result = FindAdaptiveThreshold(measures, target, target + 1);
    EXPECT_EQ(result.status, ThresholdStatus::kConverged) << target;
    EXPECT_EQ(result.num_rounds, rounds) << target;
    EXPECT_GE(result.count, target);
    EXPECT_LE(result.count, target + 1);
    EXPECT_EQ(CountAtLeast(measures, result.threshold), result.count);
  }
}

TEST(AdaptiveThresholdTest, NeighbouringFloatsAreToldApart) {
  std::vector<float> measures;
  float value = 100;
  for (int i = 0; i < 1000; ++i) {
    measures.push_back(value);
    value = std::nextafter(value, 255.0f);
  }
  for (const int target : {1, 2, 499, 998, 1000}) {
    const AdaptiveThreshold result = FindAdaptiveThreshold(measures, target, target);
    EXPECT_EQ(result.status, ThresholdStatus::kConverged);
    EXPECT_EQ(result.count, target);
    EXPECT_EQ(CountAtLeast(measures, result.threshold), target);
  }
}

TEST(AdaptiveThresholdTest, AllEqual) {
  for (const float value : {0.0f, 17.3f, 255.0f}) {
    const std::vector<float> measures(50, value);
    const AdaptiveThreshold fits = FindAdaptiveThreshold(measures, 40, 60);
    EXPECT_EQ(fits.status, ThresholdStatus::kConverged);
    EXPECT_EQ(fits.count, 50);
    EXPECT_EQ(fits.threshold, value);
    const AdaptiveThreshold tied = FindAdaptiveThreshold(measures, 10, 20);
    EXPECT_EQ(tied.status, ThresholdStatus::kTied);
    EXPECT_EQ(tied.count, 0);
    EXPECT_EQ(tied.num_rounds, 1);
  }
}

TEST(AdaptiveThresholdTest, TiesThatStraddleKeepTheStrongerGroups) {
  std::vector<float> measures = {250, 240, 240, 230};
  measures.insert(measures.end(), 30, 100.0f);
  measures.insert(measures.end(), 30, 100.001f);
  measures.insert(measures.end(), 30, 10.0f);
  const AdaptiveThreshold result = FindAdaptiveThreshold(measures, 10, 20);
  EXPECT_EQ(result.status, ThresholdStatus::kTied);
  EXPECT_EQ(result.count, 4);
  EXPECT_EQ(result.threshold, 230);
  const AdaptiveThreshold below = FindAdaptiveThreshold(measures, 40, 60);
  EXPECT_EQ(below.status, ThresholdStatus::kTied);
  EXPECT_EQ(below.count, 34);
  EXPECT_EQ(below.threshold, 100.001f);
}

TEST(AdaptiveThresholdTest, FewerThanTheMinimumKeepsAll) {
  const std::vector<float> measures = {0, 3, 255};
  const AdaptiveThreshold result = FindAdaptiveThreshold(measures, 4, 10);
  EXPECT_EQ(result.status, ThresholdStatus::kTooFew);
  EXPECT_EQ(result.count, 3);
  EXPECT_EQ(result.threshold, 0);
}

TEST(AdaptiveThresholdTest, EmptyIsFlat) {
  const AdaptiveThreshold result = FindAdaptiveThreshold({}, 1, 10);
  EXPECT_EQ(result.status, ThresholdStatus::kFlat);
  EXPECT_EQ(result.count, 0);
}

TEST(AdaptiveThresholdTest, TheEndsOfTheRangeCount) {
  std::vector<float> measures;
  Append(10, 255, 255, &measures);
  Append(10, 0, 0, &measures);
  EXPECT_EQ(FindAdaptiveThreshold(measures, 10, 15).count, 10);
  EXPECT_EQ(FindAdaptiveThreshold(measures, 10, 15).threshold, 255);
  EXPECT_EQ(FindAdaptiveThreshold(measures, 20, 20).count, 20);
  EXPECT_EQ(FindAdaptiveThreshold(measures, 20, 20).threshold, 0);
}

// By sorting: the thresholds that matter are the values themselves.
struct SortedTruth {
  bool reachable = false;  // some threshold keeps a count in the interval
  int best_below = 0;      // the greatest count below the interval that a threshold can keep
};

SortedTruth SortAndLook(std::vector<float> measures, int min_count, int max_count) {
  std::sort(measures.begin(), measures.end(), std::greater<>());
  SortedTruth truth;
  for (size_t i = 0; i < measures.size(); ++i) {
    if (i + 1 < measures.size() && measures[i + 1] == measures[i]) continue;
    const int count = static_cast<int>(i) + 1;
    if (count < min_count) truth.best_below = count;
    if (count >= min_count && count <= max_count) truth.reachable = true;
  }
  return truth;
}

std::vector<float> RandomMeasures(std::mt19937* generator) {
  const int count = 1 + static_cast<int>((*generator)() % 300);
  const int shape = static_cast<int>((*generator)() % 5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<float> measures;
  for (int i = 0; i < count; ++i) {
    const double u = uniform(*generator);
    const double value = shape == 0   ? u
                         : shape == 1 ? std::pow(u, 20)
                         : shape == 2 ? std::round(u * 12) / 12
                         : shape == 3 ? std::exp(-30 * u)
                                      : 0.5 + 1e-7 * std::round(20 * u);
    measures.push_back(static_cast<float>(255 * value));
  }
  return measures;
}

TEST(AdaptiveThresholdTest, FindsAThresholdWheneverOneExists) {
  std::mt19937 generator(11);
  int num_converged = 0, num_tied = 0, num_too_few = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const std::vector<float> measures = RandomMeasures(&generator);
    const int min_count = 1 + static_cast<int>(generator() % 200);
    const int max_count = min_count + static_cast<int>(generator() % 8);
    const AdaptiveThreshold result = FindAdaptiveThreshold(measures, min_count, max_count);
    const SortedTruth truth = SortAndLook(measures, min_count, max_count);
    ASSERT_EQ(result.status == ThresholdStatus::kConverged, truth.reachable) << trial;
    if (result.count > 0) {
      ASSERT_EQ(CountAtLeast(measures, result.threshold), result.count);
    }
    if (truth.reachable) {
      ASSERT_GE(result.count, min_count);
      ASSERT_LE(result.count, max_count);
      ++num_converged;
    } else {
      ASSERT_EQ(result.count, truth.best_below);
      const bool too_few = static_cast<int>(measures.size()) < min_count;
      ASSERT_EQ(result.status, too_few ? ThresholdStatus::kTooFew : ThresholdStatus::kTied);
      ++(too_few ? num_too_few : num_tied);
    }
    constexpr float kNone = std::numeric_limits<float>::infinity();
    ASSERT_EQ(OracleThreshold(measures, min_count, max_count),
              result.count > 0 ? result.threshold : kNone);
  }
  EXPECT_GT(num_converged, 500);
  EXPECT_GT(num_tied, 100);
  EXPECT_GT(num_too_few, 500);
}

}  // namespace
}  // namespace colmap_seapoint
