#include "feature/retrieval/loop_candidates.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <tuple>
#include <unordered_map>

namespace colmap_seapoint {
namespace {

constexpr int kReach = 2;      // pictures before and after that count along
constexpr int kOwnWeight = 3;  // of a pair's own votes
// Measured on synthetic dives of 2,000 clear pictures: one picture in four gets a candidate without
// any overlap, and 19 of 20 pairs that overlap by 30 % are found. In murk a higher limit loses
// pairs.
constexpr int kMinSupport = 12;

// Places a and b, smaller first, in one number: sorts by a, then b.
uint64_t Key(uint32_t a, uint32_t b) {
  return static_cast<uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
}

using Scores = std::unordered_map<uint64_t, int>;

// Each pair once, with the higher score of the two queries.
Scores CollectScores(const std::vector<std::vector<RetrievedPicture>>& retrieved, int overlap) {
  Scores scores;
  for (uint32_t query = 0; query < retrieved.size(); ++query) {
    for (const RetrievedPicture& one : retrieved[query]) {
      if (std::abs(static_cast<int>(query) - static_cast<int>(one.picture)) <= overlap) continue;
      int& score = scores[Key(query, one.picture)];
      score = std::max(score, one.score);
    }
  }
  return scores;
}

// The median score of all pairs: in a dive of thousands 0, in a small one a few, since there all
// votes fall on few pictures.
int ChanceScore(const Scores& scores, size_t num_pictures, int overlap) {
  std::map<int, uint64_t> histogram;
  for (const auto& [key, score] : scores) ++histogram[score];
  uint64_t num_pairs = 0;
  for (size_t gap = static_cast<size_t>(overlap) + 1; gap < num_pictures; ++gap) {
    num_pairs += num_pictures - gap;
  }
  uint64_t rest = num_pairs / 2;  // from the top
  for (auto level = histogram.rbegin(); level != histogram.rend(); ++level) {
    if (level->second > rest) return level->first;
    rest -= level->second;
  }
  return 0;
}

int AboveChance(const Scores& scores, int64_t a, int64_t b, int chance) {
  if (a < 0 || b < 0) return 0;
  const auto score = scores.find(Key(static_cast<uint32_t>(a), static_cast<uint32_t>(b)));
  return score == scores.end() ? 0 : std::max(0, score->second - chance);
}

int Support(const Scores& scores, int64_t a, int64_t b, int chance) {
  int support = (kOwnWeight - 1) * AboveChance(scores, a, b, chance);
  for (int64_t i = a - kReach; i <= a + kReach; ++i) {
    for (int64_t j = b - kReach; j <= b + kReach; ++j) support += AboveChance(scores, i, j, chance);
  }
  return support;
}

}  // namespace

std::vector<LoopCandidate> ChooseLoopCandidates(
    const std::vector<std::vector<RetrievedPicture>>& retrieved, int overlap, int max_per_picture) {
  const Scores scores = CollectScores(retrieved, overlap);
  const int chance = ChanceScore(scores, retrieved.size(), overlap);
  std::vector<std::vector<LoopCandidate>> by_picture(retrieved.size());
  for (const auto& [key, score] : scores) {
    const auto first = static_cast<uint32_t>(key >> 32), second = static_cast<uint32_t>(key);
    const LoopCandidate candidate = {first, second, Support(scores, first, second, chance)};
    if (candidate.support < kMinSupport) continue;
    by_picture[first].push_back(candidate);
    by_picture[second].push_back(candidate);
  }
  const auto is_before = [](const LoopCandidate& a, const LoopCandidate& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  };
  std::vector<LoopCandidate> chosen;
  for (std::vector<LoopCandidate>& ranked : by_picture) {
    std::sort(ranked.begin(), ranked.end(), [&](const auto& a, const auto& b) {
      return a.support != b.support ? a.support > b.support : is_before(a, b);
    });
    const size_t count = std::min(ranked.size(), static_cast<size_t>(max_per_picture));
    chosen.insert(chosen.end(), ranked.begin(),
                  ranked.begin() + static_cast<std::ptrdiff_t>(count));
  }
  std::sort(chosen.begin(), chosen.end(), is_before);
  const auto is_same = [](const LoopCandidate& a, const LoopCandidate& b) {
    return a.first == b.first && a.second == b.second;
  };
  chosen.erase(std::unique(chosen.begin(), chosen.end(), is_same), chosen.end());
  return chosen;
}

}  // namespace colmap_seapoint
