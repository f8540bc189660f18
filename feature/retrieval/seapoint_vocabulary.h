// A vocabulary of rBRIEF words, trained on the spot from a dive's own descriptors (ours): a tree of
// k-majority clusters over bits. Nothing to download, and no two dives look alike anyway.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

namespace bits {
struct TwoNearest;
}

class SeaPointVocabulary {
 public:
  // A vocabulary of one word, as an empty sample gives it.
  SeaPointVocabulary() : SeaPointVocabulary({}, 1, 0) {}

  // Trains at most `num_words` words, each for about the same share of `sample`, and fewer where
  // descriptors are alike. The result is the same for any order of the sample. O(n log(num_words)),
  // about 1 us a descriptor, on the caller's thread.
  SeaPointVocabulary(std::vector<Descriptor> sample, size_t num_words, int seed);

  size_t NumWords() const { return num_words_; }

  // Returns the word at the end of the nearest way down the tree, and the one that is reached by
  // taking the second nearest branch where that costs the fewest bits; the same word twice when
  // there is only one. Any number of threads. About 0.2 us.
  std::array<uint32_t, 2> NearestWords(const Descriptor& descriptor) const;
  uint32_t NearestWord(const Descriptor& descriptor) const;

 private:
  struct Node {
    uint32_t first_child = 0;   // into nodes_ and centres_: children are neighbours
    uint32_t num_children = 0;  // 0: a word
    uint32_t word = 0;
  };
  using Centre = std::array<uint64_t, 4>;

  void Split(uint32_t node, Centre* begin, Centre* end, size_t num_words, int seed);
  bits::TwoNearest NearestChildren(uint32_t node, const Centre& descriptor) const;
  uint32_t Descend(uint32_t node, const Centre& descriptor) const;

  std::vector<Node> nodes_;  // the root first
  std::vector<Centre> centres_;
  size_t num_words_ = 0;
};

}  // namespace colmap_seapoint
