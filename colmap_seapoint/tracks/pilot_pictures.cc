#include "colmap_seapoint/tracks/pilot_pictures.h"

#include <algorithm>
#include <map>

namespace colmap_seapoint {
namespace {

constexpr uint32_t kMinMatches = 30;
constexpr size_t kPairsOfStart = 12;  // of a picture, that make it a good start

struct Tie {
  uint32_t picture_idx;
  uint32_t num_matches;
};
using Ties = std::vector<std::vector<Tie>>;  // a picture

Ties TiesOf(uint32_t num_pictures, const std::vector<TiedPair>& pairs) {
  Ties ties(num_pictures);
  for (const TiedPair& pair : pairs) {
    if (pair.num_matches < kMinMatches) continue;
    ties[pair.picture_idx1].push_back({pair.picture_idx2, pair.num_matches});
    ties[pair.picture_idx2].push_back({pair.picture_idx1, pair.num_matches});
  }
  return ties;
}

uint64_t StrengthOf(std::vector<Tie> ties) {
  std::sort(ties.begin(), ties.end(),
            [](const Tie& a, const Tie& b) { return a.num_matches > b.num_matches; });
  uint64_t sum = 0;
  for (size_t i = 0; i < std::min(kPairsOfStart, ties.size()); ++i) sum += ties[i].num_matches;
  return sum;
}

// Those that are tied to a chosen picture and not chosen yet; those with most matches first.
std::vector<uint32_t> Neighbours(const Ties& ties, const std::vector<uint32_t>& chosen) {
  std::map<uint32_t, uint64_t> num_matches;
  for (const uint32_t picture : chosen) {
    for (const Tie& tie : ties[picture]) num_matches[tie.picture_idx] += tie.num_matches;
  }
  for (const uint32_t picture : chosen) num_matches.erase(picture);
  std::vector<uint32_t> neighbours;
  for (const auto& [picture, count] : num_matches) neighbours.push_back(picture);
  std::stable_sort(neighbours.begin(), neighbours.end(),
                   [&](uint32_t a, uint32_t b) { return num_matches.at(a) > num_matches.at(b); });
  return neighbours;
}

}  // namespace

std::vector<uint32_t> ChoosePilotPictures(uint32_t num_pictures, const std::vector<TiedPair>& pairs,
                                          uint32_t count) {
  const Ties ties = TiesOf(num_pictures, pairs);
  std::vector<uint64_t> strengths;
  for (const auto& of_picture : ties) strengths.push_back(StrengthOf(of_picture));
  const auto strongest = std::max_element(strengths.begin(), strengths.end());
  if (strongest == strengths.end() || *strongest == 0) return {};

  std::vector<uint32_t> chosen = {static_cast<uint32_t>(strongest - strengths.begin())};
  while (chosen.size() < count) {
    std::vector<uint32_t> next = Neighbours(ties, chosen);
    if (next.empty()) break;
    next.resize(std::min<size_t>(next.size(), count - chosen.size()));
    chosen.insert(chosen.end(), next.begin(), next.end());
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace colmap_seapoint
