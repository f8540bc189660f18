// What a job is made of, and what each kind of its work is expected to cost on this machine (ours).
#pragma once

#include <array>
#include <cstdint>

#include "colmap_seapoint/base/work.h"

namespace colmap_seapoint {

// A value for each kind of work.
template <typename T>
struct OfWork {
  std::array<T, kNumWorks> values{};
  T& operator[](Work work) { return values[static_cast<size_t>(work)]; }
  const T& operator[](Work work) const { return values[static_cast<size_t>(work)]; }
};

struct JobSize {
  int64_t num_pictures = 0;
  double megapixels = 0;  // of all pictures together
  int64_t num_pairs = 0;  // to be matched; of pairs that look alike, as many as there commonly are
  int step = 0;           // pixels between samples of the cloud; 0 = about 0.75 million a picture
  bool finds_look_alikes = false;
  bool writes_maps = false;
  bool makes_map = false;
  bool reports_completeness = false;
  bool finds_markers = false;
  // To be made into pictures before all else, of one kind or the other.
  int64_t num_copies = 0;         // pictures in HEIC and RAW
  int64_t video_seconds = 0;      // all clips together
  double decoded_megapixels = 0;  // of the copies, or of all frames
  int num_threads = 1;
};

// Expected pairs of a sequential matching: each picture with `overlap` that follow, and as many and
// one again of look-alikes, where those are sought.
int64_t ExpectedSequentialPairs(int64_t num_pictures, int overlap, bool finds_look_alikes);

struct WorkCost {
  // As its Progress will count. 0: none of it is expected; there may be some all the same.
  int64_t count = 0;
  double seconds_each = 0;  // wall clock
};

// From measured costs: those of Debian 12 on two cores of 2.5 GHz, times `machine`, the ratios that
// this machine's earlier runs have shown (work_history.h), all 1 where there are none.
OfWork<WorkCost> ExpectedCosts(const JobSize& size, const OfWork<double>& machine);

}  // namespace colmap_seapoint
