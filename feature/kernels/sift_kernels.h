// The inner loop of MatchSift: vector code chosen at run time, the same result from every version.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {
namespace sift {

// The neighbour in the other set with the largest inner product, of equal ones the smallest index;
// products up to the floor are not looked at, and count as the floor.
struct Nearest {
  int dot = 0;
  int second_dot = 0;  // of the second nearest; kept up to date only if it is asked for
  uint32_t idx = 0;
};

// Fills both vectors (as long as the sets), each element of which starts as {floor, floor, 0}.
void FindNearest(const std::vector<SiftDescriptor>& descriptors1,
                 const std::vector<SiftDescriptor>& descriptors2, bool with_second,
                 std::vector<Nearest>* nearest1, std::vector<Nearest>* nearest2);

}  // namespace sift
}  // namespace colmap_seapoint
