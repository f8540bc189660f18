// The kernels that find nearest neighbours, for rBRIEF and for SIFT, share this: one pass over all
// pairs of two sets finds the nearest of every descriptor in the other set, both ways.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace colmap_seapoint {

// The nearest neighbour in the other set, of equal ones the one with the smallest index. Distances
// are whole numbers of the kernel's own measure. Searches start from a cap: distances that reach it
// are not looked at, and count as the cap.
struct Nearest {
  int distance = 0;
  int second_distance = 0;  // of the second nearest; kept up to date only if it is asked for
  uint32_t idx = 0;
};

struct NearestNeighbors {
  std::vector<Nearest> of1, of2;  // by descriptor of the first set, of the second set
};

// Enters the pairs that may matter; the vector code sorts out the many that do not.
class NearestRecord {
 public:
  NearestRecord(size_t count1, size_t count2, int cap, bool with_second)
      : with_second_(with_second), nearest_{{count1, {cap, cap, 0}}, {count2, {cap, cap, 0}}} {}

  // A distance changes nothing unless it is below one of these.
  int Bound1(size_t i) const { return Bound(nearest_.of1[i]); }
  int Bound2(size_t j) const { return Bound(nearest_.of2[j]); }

  // To be called once a pair, in ascending order of i for each j and of j for each i.
  void Enter(int distance, size_t i, size_t j) {
    Update(distance, static_cast<uint32_t>(j), &nearest_.of1[i]);
    Update(distance, static_cast<uint32_t>(i), &nearest_.of2[j]);
  }

  NearestNeighbors Take() { return std::move(nearest_); }

 private:
  int Bound(const Nearest& nearest) const {
    return with_second_ ? nearest.second_distance : nearest.distance;
  }

  static void Update(int distance, uint32_t idx, Nearest* nearest) {
    if (distance < nearest->distance) {
      nearest->second_distance = nearest->distance;
      nearest->distance = distance;
      nearest->idx = idx;
    } else if (distance < nearest->second_distance) {
      nearest->second_distance = distance;
    }
  }

  const bool with_second_;
  NearestNeighbors nearest_;
};

// Enters every pair. This runs on machines without vector code, and the vector code must equal it.
template <typename AnyDescriptor, typename Distance>
NearestNeighbors FindNearestOneByOne(const std::vector<AnyDescriptor>& descriptors1,
                                     const std::vector<AnyDescriptor>& descriptors2, int cap,
                                     bool with_second, const Distance& distance) {
  NearestRecord record(descriptors1.size(), descriptors2.size(), cap, with_second);
  for (size_t i = 0; i < descriptors1.size(); ++i) {
    for (size_t j = 0; j < descriptors2.size(); ++j) {
      record.Enter(distance(descriptors1[i], descriptors2[j]), i, j);
    }
  }
  return record.Take();
}

}  // namespace colmap_seapoint
