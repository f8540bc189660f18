#include "feature/retrieval/loop_candidates.h"

#include <gtest/gtest.h>

#include <set>

namespace colmap_seapoint {
namespace {

using Lists = std::vector<std::vector<RetrievedPicture>>;

RetrievedPicture One(uint32_t picture, int score) { return {picture, score}; }

std::set<std::pair<uint32_t, uint32_t>> Pairs(const std::vector<LoopCandidate>& candidates) {
  std::set<std::pair<uint32_t, uint32_t>> pairs;
  for (const LoopCandidate& one : candidates) {
    EXPECT_LT(one.first, one.second);
    pairs.insert({one.first, one.second});
  }
  return pairs;
}

TEST(LoopCandidates, NoneFromNothing) {
  EXPECT_TRUE(ChooseLoopCandidates({}, 5, 10).empty());
  EXPECT_TRUE(ChooseLoopCandidates(Lists(1), 5, 10).empty());
  EXPECT_TRUE(ChooseLoopCandidates(Lists(100), 5, 10).empty());
}

TEST(LoopCandidates, TheHigherOfTwoScoresCounts) {
  Lists lists(100);
  lists[10] = {One(60, 7)};
  lists[60] = {One(10, 9)};
  lists[30] = {One(33, 50)};  // matched anyway
  const auto candidates = ChooseLoopCandidates(lists, 5, 10);
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_EQ(candidates[0].support, 27);
  EXPECT_EQ(ChooseLoopCandidates(lists, 2, 10).size(), 2u);
}

// A weak pair is taken for what the pairs around it show, however the strips run; alone it is not.
TEST(LoopCandidates, NeighboursSupportEachOther) {
  Lists lists(200);
  for (uint32_t k = 0; k < 6; ++k) {
    lists[10 + k] = {One(100 - k, 3)};  // a strip flown back
    lists[30 + k] = {One(150 + k, 3)};  // a strip flown the same way
  }
  lists[60] = {One(120, 3)};
  const auto pairs = Pairs(ChooseLoopCandidates(lists, 5, 10));
  EXPECT_EQ(pairs.size(), 12u);
  EXPECT_EQ(pairs.count({60, 120}), 0u);
  EXPECT_EQ(pairs.count({10, 100}), 1u);
  EXPECT_EQ(pairs.count({35, 155}), 1u);
}

TEST(LoopCandidates, ChanceIsTakenOff) {
  constexpr uint32_t kCount = 30;
  Lists lists(kCount);
  for (uint32_t i = 0; i < kCount; ++i) {
    for (uint32_t j = 0; j < kCount; ++j) {
      if (i != j) lists[i].push_back(One(j, (i == 3 && j == 20) || (i == 20 && j == 3) ? 15 : 6));
    }
  }
  const auto candidates = ChooseLoopCandidates(lists, 2, 10);
  // The one pair, and those next to it which its votes speak for a little.
  ASSERT_FALSE(candidates.empty());
  for (const LoopCandidate& one : candidates) {
    EXPECT_EQ(Pairs({one}), (std::set<std::pair<uint32_t, uint32_t>>{{3, 20}}));
    EXPECT_EQ(one.support, 27);
  }
}

TEST(LoopCandidates, EachPictureGetsItsBest) {
  Lists lists(400);
  for (uint32_t k = 1; k <= 12; ++k) lists[0].push_back(One(30 * k, 20 + static_cast<int>(k)));
  const auto pairs = Pairs(ChooseLoopCandidates(lists, 5, 3));
  // Picture 0 has three; the others have it as their only one.
  EXPECT_EQ(pairs.size(), 12u);
  Lists crowded(400);
  for (uint32_t k = 1; k <= 12; ++k) {
    crowded[0].push_back(One(30 * k, 20 + static_cast<int>(k)));
    for (uint32_t other = 1; other <= 3; ++other) {
      crowded[30 * k].push_back(One(30 * k > 200 ? other * 50 : 200 + other * 50 + k, 40));
    }
  }
  const auto chosen = ChooseLoopCandidates(crowded, 5, 3);
  std::vector<int> count(crowded.size(), 0);
  for (const LoopCandidate& one : chosen) {
    if (one.first == 0) ++count[0];
  }
  EXPECT_EQ(count[0], 3);
  for (size_t i = 1; i < chosen.size(); ++i) {
    EXPECT_LT(std::pair(chosen[i - 1].first, chosen[i - 1].second),
              std::pair(chosen[i].first, chosen[i].second));
  }
}

}  // namespace
}  // namespace colmap_seapoint
