// The inner loop of MatchHamming: vector code chosen at run time, the same result from every
// version.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {
namespace hamming {

// The nearest neighbour in the other set, of equal ones the smallest index; distances from the cap
// on are not looked at, and count as the cap.
struct Nearest {
  int distance = 0;
  int second_distance = 0;  // of the second nearest; kept up to date only if it is asked for
  uint32_t idx = 0;
};

// Fills both vectors (as long as the sets), each element of which starts as {cap, cap, 0}.
void FindNearest(const std::vector<Descriptor>& descriptors1,
                 const std::vector<Descriptor>& descriptors2, bool with_second,
                 std::vector<Nearest>* nearest1, std::vector<Nearest>* nearest2);

}  // namespace hamming
}  // namespace colmap_seapoint
