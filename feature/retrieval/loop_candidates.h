// From what each picture of a sequence looks like to the pairs that are worth a closer look (ours).
#pragma once

#include <vector>

#include "feature/retrieval/seapoint_retrieval.h"

namespace colmap_seapoint {

// Raise it whenever the same SeaPoints give other loop pairs than before, together with the hash in
// tests/feature/retrieval_version_test.cc.
inline constexpr char kRetrievalVersion[] = "1";

struct LoopCandidate {
  uint32_t first = 0, second = 0;  // places in the sequence, smaller first
  int support = 0;                 // votes above chance, those of the pairs nearby included
};

// `retrieved`: one list a picture, in the order of the sequence, with low scores too. Where two
// pictures show the same place, so do those before and after them: votes of the pairs around, along
// the sequence, count along, less what chance gives to any pair. Each picture gets its best
// `max_per_picture`; no pair of which one is among the `overlap` followers of the other. By the
// smaller place, then the greater. About 50 us a picture.
std::vector<LoopCandidate> ChooseLoopCandidates(
    const std::vector<std::vector<RetrievedPicture>>& retrieved, int overlap, int max_per_picture);

}  // namespace colmap_seapoint
