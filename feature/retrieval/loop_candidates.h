// Chooses the pairs of a sequence that are worth a closer look, because the pictures that look like
// one another lie along each other (ours).
#pragma once

#include <vector>

#include "feature/retrieval/seapoint_retrieval.h"

namespace colmap_seapoint {

// Raise it whenever the same SeaPoints give other loop pairs than before, together with the hash in
// tests/feature/retrieval_version_test.cc.
inline constexpr char kRetrievalVersion[] = "2";

struct LoopCandidate {
  uint32_t first = 0, second = 0;  // places in the sequence, smaller first
  int support = 0;                 // votes above chance, those of the pairs nearby included
};

// `retrieved` holds one list a picture, in the order of the sequence, with low scores too. Where
// two pictures show the same place, so do those before and after them: the votes of the pairs
// around a pair, along the sequence, count along, less what chance gives to any pair. Each picture
// gets its best `max_per_picture` candidates; pairs at most `overlap` places apart are matched
// anyway and left out. Sorted by first, then second. About 50 us a picture.
std::vector<LoopCandidate> ChooseLoopCandidates(
    const std::vector<std::vector<RetrievedPicture>>& retrieved, int overlap, int max_per_picture);

}  // namespace colmap_seapoint
