#include "feature/kernels/bit_kernels.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "feature/kernels/bit_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace bits {
namespace HWY_NAMESPACE {

size_t FindNear(const Signature& query, const Signature* first, size_t stride_bytes, size_t count,
                int max_distance, Near* near_ones) {
  uint64_t low;
  std::memcpy(&low, query.data(), sizeof(low));
  const uint32_t high = query[2];
  const auto* at = reinterpret_cast<const char*>(first);
  size_t num_found = 0;
  for (size_t i = 0; i < count; ++i, at += stride_bytes) {
    uint64_t other_low;
    uint32_t other_high;
    std::memcpy(&other_low, at, sizeof(other_low));
    std::memcpy(&other_high, at + sizeof(other_low), sizeof(other_high));
    const int distance =
        __builtin_popcountll(low ^ other_low) + __builtin_popcount(high ^ other_high);
    near_ones[num_found] = {static_cast<uint32_t>(i), distance};
    num_found += distance <= max_distance ? 1 : 0;
  }
  return num_found;
}

TwoNearest FindTwoNearest(const WholeBits& query, const WholeBits* centres, size_t count) {
  TwoNearest found;
  for (size_t i = 0; i < count; ++i) {
    const WholeBits& centre = centres[i];
    const int distance =
        __builtin_popcountll(query[0] ^ centre[0]) + __builtin_popcountll(query[1] ^ centre[1]) +
        __builtin_popcountll(query[2] ^ centre[2]) + __builtin_popcountll(query[3] ^ centre[3]);
    if (distance < found.distance) {
      found.second = found.nearest;
      found.second_distance = found.distance;
      found.nearest = static_cast<uint32_t>(i);
      found.distance = distance;
    } else if (distance < found.second_distance) {
      found.second = static_cast<uint32_t>(i);
      found.second_distance = distance;
    }
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace bits
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace bits {

HWY_EXPORT(FindNear);
HWY_EXPORT(FindTwoNearest);

size_t FindNear(const Signature& query, const Signature* first, size_t stride_bytes, size_t count,
                int max_distance, Near* near_ones) {
  return HWY_DYNAMIC_DISPATCH(FindNear)(query, first, stride_bytes, count, max_distance, near_ones);
}

TwoNearest FindTwoNearest(const WholeBits& query, const WholeBits* centres, size_t count) {
  return HWY_DYNAMIC_DISPATCH(FindTwoNearest)(query, centres, count);
}

}  // namespace bits
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
