// What densification tells of a sequence while it runs and when it is done.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "densify/cloud/partial_cloud.h"
#include "densify/sequence/picture_source.h"

namespace colmap_seapoint {

// One row of pairs.csv: a pair that was densified, or a picture that was passed over.
struct PairReport {
  int image_idx1 = -1;
  int image_idx2 = -1;  // -1: image1 was skipped as the first picture of a pair
  std::string pass;     // "sequence" or "completion"
  std::string skipped;  // why, or empty
  double baseline = 0;  // model units
  double overlap = 0;   // share of image1 already covered by what came before, 0..1
  int num_oa = 0, num_na = 0, num_rea = 0;  // SeaPoints of image1 by label
  int num_seeds = 0;
  int num_failed_seeds = 0;  // seeds that did not spread
  int64_t num_points = 0;
  double rectification_seconds = 0, propagation_seconds = 0, total_seconds = 0;  // wall
};

struct SequenceReport {
  std::vector<PairReport> pairs;
  std::vector<LeftOutPicture> left_out;  // pictures that could not be read
  int64_t num_points = 0;
  int64_t num_triangulated = 0;  // points made of matches, where the model has none that two see
};

struct PairDebug;

// What comes out on the way, in processing order, from the caller's thread.
struct SequenceCallbacks {
  std::function<void(const PartialCloud&)> sink;              // each partial local cloud
  std::function<void(int64_t done, int64_t total)> progress;  // now and then; optional
  // Optional: every pair that was densified. Then each is densified in full too, for comparison.
  std::function<void(const PairDebug&)> debug;
};

}  // namespace colmap_seapoint
