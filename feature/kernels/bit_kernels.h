// Distances in bits for the retrieval of pictures: plain loops around the processor's own count of
// bits where it has one (chosen at run time); the same result from every version.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace colmap_seapoint {
namespace bits {

using Signature = std::array<uint32_t, 3>;  // 96 of a descriptor's bits
using WholeBits = std::array<uint64_t, 4>;  // all 256 of them

struct Near {
  uint32_t idx;
  int distance;
};

// Writes those of `count` signatures that differ from the query by at most `max_distance` bits, in
// their order, and returns how many they are. `stride_bytes` from one signature to the next;
// near_ones has room for all of them. About 1 ns a signature.
size_t FindNear(const Signature& query, const Signature* first, size_t stride_bytes, size_t count,
                int max_distance, Near* near_ones);

struct TwoNearest {
  uint32_t nearest = 0, second = 0;
  int distance = 257, second_distance = 257;  // 257: there is none
};

// Of equal ones the smaller index is nearer.
TwoNearest FindTwoNearest(const WholeBits& query, const WholeBits* centres, size_t count);

}  // namespace bits
}  // namespace colmap_seapoint
