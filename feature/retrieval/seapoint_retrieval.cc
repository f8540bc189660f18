#include "feature/retrieval/seapoint_retrieval.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <tuple>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/rbrief_pattern.h"
#include "feature/kernels/bit_kernels.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kPointsPerWord = 256;
constexpr size_t kSampleStride = 10;
// The matcher's default, 80 of 256 bits, in proportion to the 96 bits of a signature.
constexpr int kMaxSignatureDistance = 30;
// A word that holds many times its share is texture that is everywhere: it tells nothing.
constexpr size_t kMaxWordSize = 8 * kPointsPerWord;
// A SeaPoint votes for its nearest few of all pictures: what is like it everywhere (shaded sand,
// dark corners) would otherwise outvote the places that two pictures share.
constexpr size_t kVotesPerPoint = 3;
// Only so many pictures, those with the most votes, are asked whether their votes agree.
constexpr size_t kMinRanked = 64;

// A query's descriptors are turned by so many steps to either side of their orientation.
constexpr int kTurnReach = 1;

constexpr double kTurn = 2 * 3.14159265358979323846;
constexpr int kAngleSteps = 256;
constexpr int kAngleWindow = 20;  // steps to either side that agree on a rotation: 28 degrees
constexpr int kNumCells = 24;     // half cells along the longest side of the pictures

int AngleStep(float radians) {
  const double turns = static_cast<double>(radians) / kTurn;
  return static_cast<int>(std::lround((turns - std::floor(turns)) * kAngleSteps)) % kAngleSteps;
}

uint16_t Pixel(float coordinate) {
  return static_cast<uint16_t>(std::lround(std::clamp(coordinate, 0.0f, 65535.0f)));
}

bits::Signature SignatureOf(const Descriptor& descriptor) {
  bits::Signature signature;
  std::memcpy(signature.data(), descriptor.data(), sizeof(signature));
  return signature;
}

// The descriptor turned back by its point's orientation and `extra` steps: how the pictures are
// turned is not known yet. Single orientations err by some steps, but many do not.
Descriptor Canonical(const Features& features, size_t i, int extra) {
  const auto steps = static_cast<int>(std::lround(features.points[i].orientation / kTurnStep));
  return TurnDescriptor(features.descriptors[i], extra - steps);
}

// The middle of the window of steps, all around, that holds most: nearest to 0 of equals.
int BestWindow(const std::array<int, kAngleSteps>& histogram) {
  const auto at = [&](int step) {
    return histogram[static_cast<size_t>((step + kAngleSteps) % kAngleSteps)];
  };
  int count = 0;
  for (int step = -kAngleWindow; step <= kAngleWindow; ++step) count += at(step);
  int best = 0, best_count = count;
  for (int middle = 1; middle < kAngleSteps; ++middle) {
    count += at(middle + kAngleWindow) - at(middle - kAngleWindow - 1);
    if (count > best_count) {
      best = middle;
      best_count = count;
    }
  }
  return best;
}

// The pictures with the most votes, `max_count` at most; of equal ones the smaller index first.
std::vector<uint32_t> RankByVotes(const std::vector<uint32_t>& counts, size_t max_count,
                                  int min_count) {
  std::vector<uint32_t> ranked;
  for (uint32_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0 && static_cast<int>(counts[i]) >= min_count) ranked.push_back(i);
  }
  std::sort(ranked.begin(), ranked.end(), [&](uint32_t a, uint32_t b) {
    return counts[a] != counts[b] ? counts[a] > counts[b] : a < b;
  });
  ranked.resize(std::min(ranked.size(), max_count));
  return ranked;
}

}  // namespace

void AppendSample(const Features& features, std::vector<Descriptor>* sample) {
  for (size_t i = 0; i < features.descriptors.size(); i += kSampleStride) {
    sample->push_back(Canonical(features, i, 0));
  }
}

size_t NumWordsFor(size_t num_points) { return std::max<size_t>(1, num_points / kPointsPerWord); }

struct SeaPointIndex::Alike {
  int distance;
  const Entry* entry;

  // Ties are broken by content, so that the order of the pictures does not matter.
  friend bool operator<(const Alike& a, const Alike& b) {
    const auto key = [](const Alike& alike) {
      return std::tie(alike.distance, alike.entry->signature, alike.entry->x, alike.entry->y,
                      alike.entry->picture_and_angle);
    };
    return key(a) < key(b);
  }
};

struct SeaPointIndex::Vote {
  uint32_t picture;
  uint32_t point;  // of the query
  int angle_step;  // from the query to the picture
  uint16_t x, y;   // in the picture
};

SeaPointIndex::SeaPointIndex(SeaPointVocabulary vocabulary, size_t num_points)
    : vocabulary_(std::move(vocabulary)) {
  words_.reserve(num_points);
  entries_.reserve(num_points);
}

SeaPointIndex::Picture SeaPointIndex::MakeEntries(const Features& features) const {
  Picture picture;
  for (size_t i = 0; i < features.points.size(); ++i) {
    const SeaPoint& point = features.points[i];
    const Descriptor descriptor = Canonical(features, i, 0);
    picture.words.push_back(vocabulary_.NearestWord(descriptor));
    picture.entries.push_back({SignatureOf(descriptor),
                               static_cast<uint32_t>(AngleStep(point.orientation)), Pixel(point.x),
                               Pixel(point.y)});
  }
  return picture;
}

void SeaPointIndex::Add(const Picture& picture) {
  SEAPOINT_CHECK(num_pictures_ < 1u << 24);
  SEAPOINT_CHECK(word_begins_.empty());
  words_.insert(words_.end(), picture.words.begin(), picture.words.end());
  for (Entry entry : picture.entries) {
    entry.picture_and_angle |= num_pictures_ << 8;
    entries_.push_back(entry);
  }
  ++num_pictures_;
}

// Sorts the entries by word where they lie: a second copy would double the memory.
void SeaPointIndex::Finish() {
  word_begins_.assign(vocabulary_.NumWords() + 1, 0);
  for (const uint32_t word : words_) ++word_begins_[word + 1];
  for (size_t w = 0; w + 1 < word_begins_.size(); ++w) word_begins_[w + 1] += word_begins_[w];
  std::vector<size_t> next(word_begins_.begin(), word_begins_.end() - 1);
  for (size_t w = 0; w < next.size(); ++w) {
    while (next[w] < word_begins_[w + 1]) {
      const size_t here = next[w], there = next[words_[here]]++;
      std::swap(entries_[here], entries_[there]);
      std::swap(words_[here], words_[there]);
    }
  }
  words_ = std::vector<uint32_t>();
  uint16_t extent = 1;
  for (const Entry& entry : entries_) extent = std::max({extent, entry.x, entry.y});
  cell_ = static_cast<float>(extent) / static_cast<float>(kNumCells);
}

// Takes the entries within the descriptor's two words that are nearer than what is there.
void SeaPointIndex::FindAlike(const Descriptor& descriptor, const std::vector<bool>& is_excluded,
                              std::vector<Alike>* nearest) const {
  const auto signature = SignatureOf(descriptor);
  const auto words = vocabulary_.NearestWords(descriptor);
  std::array<bits::Near, kMaxWordSize> near_ones;
  for (size_t w = 0; w < (words[0] == words[1] ? 1u : 2u); ++w) {
    const Entry* begin = entries_.data() + word_begins_[words[w]];
    const size_t count = word_begins_[words[w] + 1] - word_begins_[words[w]];
    if (count == 0 || count > kMaxWordSize) continue;
    const int max_distance =
        nearest->size() < kVotesPerPoint ? kMaxSignatureDistance : nearest->back().distance;
    const size_t num_near = bits::FindNear(signature, &begin->signature, sizeof(Entry), count,
                                           max_distance, near_ones.data());
    for (size_t n = 0; n < num_near; ++n) {
      const Alike one = {near_ones[n].distance, begin + near_ones[n].idx};
      if (nearest->size() == kVotesPerPoint && !(one < nearest->back())) continue;
      if (!is_excluded[one.entry->picture_and_angle >> 8]) Insert(one, nearest);
    }
  }
}

// Keeps them sorted, each entry once, and no more than vote.
void SeaPointIndex::Insert(const Alike& one, std::vector<Alike>* nearest) {
  const auto known = std::find_if(nearest->begin(), nearest->end(),
                                  [&](const Alike& other) { return other.entry == one.entry; });
  if (known != nearest->end()) {
    if (!(one < *known)) return;
    nearest->erase(known);
  }
  nearest->insert(std::upper_bound(nearest->begin(), nearest->end(), one), one);
  if (nearest->size() > kVotesPerPoint) nearest->pop_back();
}

std::vector<SeaPointIndex::Vote> SeaPointIndex::CollectVotes(
    const Features& features, const std::vector<bool>& is_excluded) const {
  std::vector<Vote> votes;
  std::vector<Alike> alike;
  for (size_t i = 0; i < features.points.size(); ++i) {
    const int angle_step = AngleStep(features.points[i].orientation);
    alike.clear();
    for (int extra = -kTurnReach; extra <= kTurnReach; ++extra) {
      FindAlike(Canonical(features, i, extra), is_excluded, &alike);
    }
    for (const Alike& one : alike) {
      const auto other_step = static_cast<int>(one.entry->picture_and_angle & 0xff);
      votes.push_back({one.entry->picture_and_angle >> 8, static_cast<uint32_t>(i),
                       (other_step - angle_step + kAngleSteps) % kAngleSteps, one.entry->x,
                       one.entry->y});
    }
  }
  return votes;
}

// The rotation that most votes agree on, then the displacement among those.
int SeaPointIndex::ScoreVotes(const Features& features, const Vote* begin, const Vote* end) const {
  std::array<int, kAngleSteps> histogram = {};
  for (const Vote* vote = begin; vote != end; ++vote) {
    ++histogram[static_cast<size_t>(vote->angle_step)];
  }
  const int middle = BestWindow(histogram);
  std::vector<const Vote*> agreeing;
  int sum = 0;
  for (const Vote* vote = begin; vote != end; ++vote) {
    // The difference, modulo a turn.
    const int off =
        ((vote->angle_step - middle + kAngleSteps / 2) & (kAngleSteps - 1)) - kAngleSteps / 2;
    if (std::abs(off) > kAngleWindow) continue;
    sum += off;
    agreeing.push_back(vote);
  }
  if (agreeing.empty()) return 0;
  const double turn = (middle + sum / static_cast<double>(agreeing.size())) * (kTurn / kAngleSteps);
  const auto cosine = static_cast<float>(std::cos(turn)), sine = static_cast<float>(std::sin(turn));
  constexpr int kSide = 5 * kNumCells;  // a turned corner moves by less than 2.5 longest sides
  std::vector<uint16_t> cells(static_cast<size_t>(kSide) * kSide, 0);
  const auto at = [&](int x, int y) -> uint16_t& {
    return cells[static_cast<size_t>(y * kSide + x)];
  };
  int score = 0;
  for (const Vote* vote : agreeing) {
    const SeaPoint& point = features.points[vote->point];
    const float dx = static_cast<float>(vote->x) - (cosine * point.x - sine * point.y);
    const float dy = static_cast<float>(vote->y) - (sine * point.x + cosine * point.y);
    const int x = static_cast<int>(std::floor(dx / cell_)) + 2 * kNumCells;
    const int y = static_cast<int>(std::floor(dy / cell_)) + 2 * kNumCells;
    if (x < 1 || y < 1 || x >= kSide || y >= kSide) continue;
    // Cells are twice as wide as their spacing: no edge cuts a peak apart.
    for (const auto& [cx, cy] : {std::pair(x, y), {x - 1, y}, {x, y - 1}, {x - 1, y - 1}}) {
      score = std::max<int>(score, ++at(cx, cy));
    }
  }
  return score;
}

// The votes of the ranked pictures side by side, in the order of `ranked`.
std::vector<SeaPointIndex::Vote> SeaPointIndex::GroupByPicture(
    const std::vector<Vote>& votes, const std::vector<uint32_t>& ranked,
    const std::vector<uint32_t>& counts) {
  constexpr auto kUnranked = static_cast<size_t>(-1);
  std::vector<size_t> next(counts.size(), kUnranked);
  size_t num_votes = 0;
  for (const uint32_t picture : ranked) {
    next[picture] = num_votes;
    num_votes += counts[picture];
  }
  std::vector<Vote> grouped(num_votes);
  for (const Vote& vote : votes) {
    if (next[vote.picture] != kUnranked) grouped[next[vote.picture]++] = vote;
  }
  return grouped;
}

std::vector<RetrievedPicture> SeaPointIndex::Query(const Features& features,
                                                   const std::vector<uint32_t>& excluded,
                                                   size_t max_count, int min_score) const {
  SEAPOINT_CHECK(!word_begins_.empty());  // Finish() was called
  std::vector<bool> is_excluded(num_pictures_, false);
  for (const uint32_t picture : excluded) is_excluded[picture] = true;
  const std::vector<Vote> votes = CollectVotes(features, is_excluded);
  std::vector<uint32_t> counts(num_pictures_, 0);
  for (const Vote& vote : votes) ++counts[vote.picture];
  const std::vector<uint32_t> ranked =
      RankByVotes(counts, std::max(kMinRanked, max_count), min_score);
  const std::vector<Vote> grouped = GroupByPicture(votes, ranked, counts);

  std::vector<RetrievedPicture> retrieved;
  const Vote* begin = grouped.data();
  for (const uint32_t picture : ranked) {
    const Vote* end = begin + counts[picture];
    const int score = ScoreVotes(features, begin, end);
    if (score >= std::max(1, min_score)) retrieved.push_back({picture, score});
    begin = end;
  }
  std::sort(retrieved.begin(), retrieved.end(), [](const auto& a, const auto& b) {
    return a.score != b.score ? a.score > b.score : a.picture < b.picture;
  });
  if (retrieved.size() > max_count) retrieved.resize(max_count);
  return retrieved;
}

}  // namespace colmap_seapoint
