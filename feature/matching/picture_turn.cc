#include "feature/matching/picture_turn.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/rbrief_pattern.h"
#include "feature/matching/hamming_matcher.h"

namespace colmap_seapoint {

namespace {

constexpr size_t kSampleSize = 400;
constexpr int kCoarseStep = 2;  // tests still answer alike when turned by half of it too much

// The strongest of every pyramid level, in proportion to the level's size. Levels follow each
// other, each with its strongest first.
std::vector<Descriptor> Strongest(const Features& features) {
  std::vector<Descriptor> sample;
  const size_t count = features.points.size();
  for (size_t begin = 0, end = 0; begin < count; begin = end) {
    while (end < count && features.points[end].scale == features.points[begin].scale) ++end;
    const size_t share = std::min(end - begin, (end - begin) * kSampleSize / count + 1);
    const auto first = features.descriptors.begin() + static_cast<std::ptrdiff_t>(begin);
    sample.insert(sample.end(), first, first + static_cast<std::ptrdiff_t>(share));
  }
  return sample;
}

// Mutual nearest neighbours vote, and near ones count much more than far ones, because chance gives
// distances of 60 and more.
int64_t Agreement(const std::vector<Descriptor>& sample1, const std::vector<Descriptor>& sample2,
                  int turn) {
  constexpr int kReach = 72;
  HammingMatcherOptions options;
  options.max_distance = kReach;
  const std::vector<Descriptor> turned = TurnDescriptors(sample1, turn);
  int64_t agreement = 0;
  for (const FeatureMatch& match : MatchHamming(turned, sample2, options)) {
    const int64_t nearness = kReach - HammingDistance(turned[match.idx1], sample2[match.idx2]);
    agreement += nearness * nearness * nearness;
  }
  return agreement;
}

}  // namespace

int FindPictureTurn(const Features& features1, const Features& features2) {
  const std::vector<Descriptor> sample1 = Strongest(features1), sample2 = Strongest(features2);
  int best_turn = 0;
  int64_t best = Agreement(sample1, sample2, 0);
  auto consider = [&](int turn) {
    const int64_t agreement = Agreement(sample1, sample2, turn);
    if (agreement > best) {
      best = agreement;
      best_turn = turn;
    }
  };
  for (int turn = kCoarseStep; turn < kNumTurns; turn += kCoarseStep) consider(turn);
  const int coarse = best_turn;
  consider((coarse + 1) % kNumTurns);
  consider((coarse + kNumTurns - 1) % kNumTurns);
  return best_turn;
}

}  // namespace colmap_seapoint
