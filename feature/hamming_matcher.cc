#include "feature/hamming_matcher.h"

#include <cstring>

#include "colmap_seapoint/base/vector_clones.h"

namespace colmap_seapoint {

namespace {

struct Words {
  uint64_t word[4];
};

std::vector<Words> ToWords(const std::vector<Descriptor>& descriptors) {
  std::vector<Words> words(descriptors.size());
  for (size_t i = 0; i < descriptors.size(); ++i) {
    std::memcpy(words[i].word, descriptors[i].data(), sizeof(Words));
  }
  return words;
}

struct Nearest {
  int distance = 257;
  int second_distance = 257;
  uint32_t idx = 0;

  void Update(int candidate, uint32_t candidate_idx) {
    if (candidate < distance) {
      second_distance = distance;
      distance = candidate;
      idx = candidate_idx;
    } else if (candidate < second_distance) {
      second_distance = candidate;
    }
  }
};

SEAPOINT_VECTOR_CLONES
void DistancesToAll(const Words& query, const Words* words, size_t count, int* distances) {
  for (size_t j = 0; j < count; ++j) {
    distances[j] = __builtin_popcountll(query.word[0] ^ words[j].word[0]) +
                   __builtin_popcountll(query.word[1] ^ words[j].word[1]) +
                   __builtin_popcountll(query.word[2] ^ words[j].word[2]) +
                   __builtin_popcountll(query.word[3] ^ words[j].word[3]);
  }
}

}  // namespace

void HammingMatcherOptions::Bind(OptionTable* table) {
  table->Add("SeaPointMatching.max_distance", &max_distance,
             "largest Hamming distance of a match, of 256 bits", "ours", 0, 256);
  table->Add("SeaPointMatching.max_ratio", &max_ratio,
             "largest ratio of nearest to second nearest distance; 1 = no test", "ours", 0.1, 1);
}

int HammingDistance(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    distance += __builtin_popcount(static_cast<unsigned>(a[i] ^ b[i]));
  }
  return distance;
}

FeatureMatches MatchHamming(const std::vector<Descriptor>& descriptors1,
                            const std::vector<Descriptor>& descriptors2,
                            const HammingMatcherOptions& options) {
  const std::vector<Words> words1 = ToWords(descriptors1), words2 = ToWords(descriptors2);
  std::vector<Nearest> nearest1(words1.size()), nearest2(words2.size());
  std::vector<int> distances(words2.size());
  for (uint32_t i = 0; i < words1.size(); ++i) {
    DistancesToAll(words1[i], words2.data(), words2.size(), distances.data());
    for (uint32_t j = 0; j < words2.size(); ++j) {
      nearest1[i].Update(distances[j], j);
      nearest2[j].Update(distances[j], i);
    }
  }
  auto passes = [&](const Nearest& nearest) {
    return nearest.distance <= options.max_distance &&
           nearest.distance <= options.max_ratio * nearest.second_distance;
  };
  FeatureMatches matches;
  for (uint32_t i = 0; i < words1.size(); ++i) {
    if (!passes(nearest1[i])) continue;
    const Nearest& back = nearest2[nearest1[i].idx];
    if (back.idx == i && passes(back)) matches.push_back({i, nearest1[i].idx});
  }
  return matches;
}

}  // namespace colmap_seapoint
