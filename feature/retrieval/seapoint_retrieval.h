// Finds the pictures that show the same place among thousands (ours): SeaPoints vote, word by word,
// for the pictures that hold their like, and the votes must agree on a rotation and a displacement.
// The cost grows linearly with the number of pictures, since the number of words grows with it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "feature/retrieval/seapoint_vocabulary.h"

namespace colmap_seapoint {

// Appends those descriptors of one picture that a vocabulary is trained on: every tenth, so that
// strong and weak ones are among them.
void AppendSample(const Features& features, std::vector<Descriptor>* sample);

// Returns the number of words for that many SeaPoints in all: a word holds about as many of them in
// a small dive as in a large one.
size_t NumWordsFor(size_t num_points);

struct RetrievedPicture {
  uint32_t picture = 0;  // index, in the order of Add
  int score = 0;         // votes that agree on one rotation and displacement

  friend bool operator==(const RetrievedPicture& a, const RetrievedPicture& b) {
    return a.picture == b.picture && a.score == b.score;
  }
};

class SeaPointIndex {
 public:
  // What the index keeps of a SeaPoint: 20 bytes, and 4 more until Finish().
  struct Entry {
    std::array<uint32_t, 3> signature;  // 96 of the descriptor's bits
    uint32_t picture_and_angle;         // index << 8 | orientation, 256 steps a turn
    uint16_t x, y;                      // pixels
  };
  struct Picture {
    std::vector<uint32_t> words;
    std::vector<Entry> entries;  // same length
  };

  // `num_points` in all, for the memory.
  SeaPointIndex(SeaPointVocabulary vocabulary, size_t num_points);

  // Any number of threads; about 0.3 us a SeaPoint.
  Picture MakeEntries(const Features& features) const;
  // The next picture, from one thread. An empty one is fine: nothing is ever like it.
  void Add(const Picture& picture);
  // Once, between the last picture and the first query.
  void Finish();

  // The pictures most like the one whose `features` are given, but for the `excluded` ones (itself
  // to begin with: it would outvote all others, as would its neighbours in a sequence). Best score
  // first, ties to the smaller index; at most `max_count`, with a score of at least `min_score`.
  // Any number of threads; scores are the same for any order of the pictures. About 8 ms for 3000
  // SeaPoints.
  std::vector<RetrievedPicture> Query(const Features& features,
                                      const std::vector<uint32_t>& excluded, size_t max_count,
                                      int min_score) const;

 private:
  struct Alike;
  struct Vote;

  void FindAlike(const Descriptor& descriptor, const std::vector<bool>& is_excluded,
                 std::vector<Alike>* nearest) const;
  static void Insert(const Alike& one, std::vector<Alike>* nearest);
  std::vector<Vote> CollectVotes(const Features& features,
                                 const std::vector<bool>& is_excluded) const;
  static std::vector<Vote> GroupByPicture(const std::vector<Vote>& votes,
                                          const std::vector<uint32_t>& ranked,
                                          const std::vector<uint32_t>& counts);
  int ScoreVotes(const Features& features, const Vote* begin, const Vote* end) const;

  SeaPointVocabulary vocabulary_;
  std::vector<uint32_t> words_;      // of the entries, until Finish()
  std::vector<Entry> entries_;       // sorted by word after Finish()
  std::vector<size_t> word_begins_;  // into entries_, one more than words
  uint32_t num_pictures_ = 0;
  float cell_ = 1;  // of the vote on displacements, pixels
};

}  // namespace colmap_seapoint
