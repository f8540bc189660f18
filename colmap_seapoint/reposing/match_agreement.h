// How well the poses of a model agree with the verified matches that they came from (ours).
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// Of a picture's keypoints: how many match an observation of another picture's point, and how many
// of these points lie within four pixels of where the picture's pose has them.
struct MatchAccount {
  int num_matches = 0;
  int num_agreeing = 0;
};

struct PairAgreement {
  uint32_t image_idx1 = 0;  // into the model's images
  uint32_t image_idx2 = 0;
  MatchAccount account1;  // the first picture's keypoints, the second one's points
  MatchAccount account2;  // the other way round
};

// All verified pairs of the database with both pictures in the model; of each pair at most 64
// matches, evenly spread over the list. To ask for points is stricter than to ask for epipolar
// lines: a picture half a metre off along its strip still has most of its matches near them.
// Observations must be the database's keypoints. Throws Error where the database cannot be read.
// About 30 microseconds a pair.
std::vector<PairAgreement> CheckMatches(const ColmapDatabase& database, const SparseModel& model);

// The pictures (into the model's images) that fewer than half of their matches agree with, when at
// least twenty speak; the worst first. One that stands wrong spoils the account of its neighbours,
// so each is judged without its pairs to those that were named before.
std::vector<uint32_t> MisplacedPictures(std::vector<PairAgreement> pairs, size_t num_images);

}  // namespace colmap_seapoint
