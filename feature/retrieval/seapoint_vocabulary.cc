#include "feature/retrieval/seapoint_vocabulary.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include "feature/kernels/bit_kernels.h"

namespace colmap_seapoint {
namespace {

using Centre = bits::WholeBits;
using Descriptors = std::vector<Centre>;

constexpr size_t kMaxChildren = 8;
constexpr int kNumRounds = 5;
// A round looks at that many descriptors a child: a majority needs no more.
constexpr size_t kSamplesPerChild = 100;

Centre ToCentre(const Descriptor& descriptor) {
  Centre centre;
  std::memcpy(centre.data(), descriptor.data(), sizeof(Centre));
  return centre;
}

uint32_t Nearest(const Centre& query, const Descriptors& centres) {
  return bits::FindTwoNearest(query, centres.data(), centres.size()).nearest;
}

// Bit by bit what most of the members have.
class Majority {
 public:
  void Add(const Centre& member) {
    ++count_;
    for (size_t bit = 0; bit < 256; ++bit) ones_[bit] += member[bit / 64] >> (bit % 64) & 1;
  }
  bool Empty() const { return count_ == 0; }
  Centre Vote() const {
    Centre centre = {};
    for (size_t bit = 0; bit < 256; ++bit) {
      if (2 * ones_[bit] > count_) centre[bit / 64] |= uint64_t{1} << (bit % 64);
    }
    return centre;
  }

 private:
  std::array<uint32_t, 256> ones_ = {};
  uint32_t count_ = 0;
};

// Up to `num_centres` different members, then rounds of k-majority over a sample of them.
Descriptors FindCentres(const Centre* begin, const Centre* end, size_t num_centres,
                        std::mt19937* random) {
  const auto count = static_cast<size_t>(end - begin);
  Descriptors centres;
  // More draws than centres: some come out alike.
  for (size_t draw = 0; draw < 4 * num_centres && centres.size() < num_centres; ++draw) {
    const Centre& drawn = begin[(*random)() % count];
    if (std::find(centres.begin(), centres.end(), drawn) == centres.end()) centres.push_back(drawn);
  }
  const size_t stride = std::max<size_t>(1, count / (kSamplesPerChild * num_centres));
  for (int round = 0; round < kNumRounds; ++round) {
    std::vector<Majority> majorities(centres.size());
    for (size_t i = 0; i < count; i += stride) majorities[Nearest(begin[i], centres)].Add(begin[i]);
    for (size_t c = 0; c < centres.size(); ++c) {
      if (!majorities[c].Empty()) centres[c] = majorities[c].Vote();
    }
  }
  return centres;
}

}  // namespace

SeaPointVocabulary::SeaPointVocabulary(std::vector<Descriptor> sample, size_t num_words, int seed) {
  // Sorted by their bits, so that the order of the pictures does not matter.
  std::sort(sample.begin(), sample.end());
  Descriptors members;
  members.reserve(sample.size());
  for (const Descriptor& descriptor : sample) members.push_back(ToCentre(descriptor));
  nodes_.resize(1);
  centres_.resize(1);
  Split(0, members.data(), members.data() + members.size(), num_words, seed);
}

void SeaPointVocabulary::Split(uint32_t node, Centre* begin, Centre* end, size_t num_words,
                               int seed) {
  const auto count = static_cast<size_t>(end - begin);
  Descriptors centres;
  if (num_words > 1 && count > 1) {
    std::mt19937 random(static_cast<unsigned>(seed) + node);
    centres = FindCentres(begin, end, std::min(num_words, kMaxChildren), &random);
  }
  std::vector<Descriptors> members(centres.size());
  for (const Centre* member = begin; member != end && !centres.empty(); ++member) {
    members[Nearest(*member, centres)].push_back(*member);
  }
  const auto is_empty = [](const Descriptors& of_child) { return of_child.empty(); };
  const auto num_empty = std::count_if(members.begin(), members.end(), is_empty);
  if (members.size() - static_cast<size_t>(num_empty) < 2) {
    nodes_[node].word = static_cast<uint32_t>(num_words_++);
    return;
  }
  const auto first_child = static_cast<uint32_t>(nodes_.size());
  for (size_t c = 0; c < members.size(); ++c) {
    if (members[c].empty()) continue;
    nodes_.emplace_back();
    centres_.push_back(centres[c]);
  }
  members.erase(std::remove_if(members.begin(), members.end(), is_empty), members.end());
  nodes_[node].first_child = first_child;
  nodes_[node].num_children = static_cast<uint32_t>(members.size());
  for (size_t c = 0; c < members.size(); ++c) {
    const size_t share = (num_words * members[c].size() + count / 2) / count;
    std::copy(members[c].begin(), members[c].end(), begin);
    Centre* const child_end = begin + members[c].size();
    Split(first_child + static_cast<uint32_t>(c), begin, child_end, std::max<size_t>(1, share),
          seed);
    begin = child_end;
  }
}

bits::TwoNearest SeaPointVocabulary::NearestChildren(uint32_t node,
                                                     const Centre& descriptor) const {
  return bits::FindTwoNearest(descriptor, &centres_[nodes_[node].first_child],
                              nodes_[node].num_children);
}

uint32_t SeaPointVocabulary::Descend(uint32_t node, const Centre& descriptor) const {
  while (nodes_[node].num_children > 0) {
    const bits::TwoNearest found = NearestChildren(node, descriptor);
    node = nodes_[node].first_child + found.nearest;
  }
  return nodes_[node].word;
}

uint32_t SeaPointVocabulary::NearestWord(const Descriptor& descriptor) const {
  return Descend(0, ToCentre(descriptor));
}

std::array<uint32_t, 2> SeaPointVocabulary::NearestWords(const Descriptor& descriptor) const {
  const Centre query = ToCentre(descriptor);
  uint32_t node = 0, detour = 0;
  int least_extra = std::numeric_limits<int>::max();
  while (nodes_[node].num_children > 0) {
    const bits::TwoNearest found = NearestChildren(node, query);
    if (found.second_distance - found.distance < least_extra) {
      least_extra = found.second_distance - found.distance;
      detour = nodes_[node].first_child + found.second;
    }
    node = nodes_[node].first_child + found.nearest;
  }
  const uint32_t word = nodes_[node].word;
  return {word, detour == 0 ? word : Descend(detour, query)};
}

}  // namespace colmap_seapoint
