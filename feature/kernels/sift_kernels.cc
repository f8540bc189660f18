#include "feature/kernels/sift_kernels.h"

#include <algorithm>

#include "hwy/aligned_allocator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "feature/kernels/sift_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

// How it works, as in hamming_kernels.cc: a lane adds up the inner product of one descriptor of the
// second set, so that nothing has to be summed across lanes. The numbers go in as pairs of 16 bits,
// two products a step and lane. What exceeds the limit of either side is entered one by one, which
// happens a few times in a descriptor's life.

// Shared by all versions.
#ifndef SEAPOINT_SIFT_KERNELS_ONCE
#define SEAPOINT_SIFT_KERNELS_ONCE
namespace colmap_seapoint {
namespace sift {
namespace {

// The larger the inner product the nearer: with its sign turned it is a distance.
int DistanceOf(const SiftDescriptor& a, const SiftDescriptor& b) {
  int dot = 0;
  for (size_t k = 0; k < a.size(); ++k) dot += static_cast<int>(a[k]) * static_cast<int>(b[k]);
  return -dot;
}

}  // namespace
}  // namespace sift
}  // namespace colmap_seapoint
#endif  // SEAPOINT_SIFT_KERNELS_ONCE

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace sift {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

NearestNeighbors FindNearest(const std::vector<SiftDescriptor>& descriptors1,
                             const std::vector<SiftDescriptor>& descriptors2, int cap,
                             bool with_second) {
  return FindNearestOneByOne(descriptors1, descriptors2, cap, with_second, DistanceOf);
}

#else

using D32 = hn::ScalableTag<int32_t>;
using D16 = hn::Repartition<int16_t, D32>;
using V32 = hn::Vec<D32>;
using V16 = hn::Vec<D16>;

constexpr size_t kNumPairs = 64;   // of numbers in a descriptor
constexpr size_t kNumQueries = 4;  // descriptors of the first set that go together

// Descriptors of the second set, as many as there are lanes in two vectors.
struct Group {
  const int16_t* pairs;  // kNumPairs times the group's lanes times two
  int32_t* limits;       // of each lane: what an inner product must exceed to matter
  size_t begin, end;
};

// Inner products of one query that exceed a limit. dots: of the group's lanes.
HWY_NOINLINE void EnterHits(const int32_t* dots, size_t i, const Group& group, size_t num_lanes,
                            NearestRecord* record) {
  for (size_t lane = 0; lane < num_lanes && group.begin + lane < group.end; ++lane) {
    if (dots[lane] <= HWY_MIN(-record->Bound1(i), group.limits[lane])) continue;
    record->Enter(-dots[lane], i, group.begin + lane);
    group.limits[lane] = -record->Bound2(group.begin + lane);
  }
}

HWY_INLINE bool CanMatter(V32 dots0, V32 dots1, int32_t query_limit, const int32_t* limits) {
  const D32 d32;
  const V32 limit = hn::Set(d32, query_limit);
  const auto hit0 = hn::Gt(dots0, hn::Min(limit, hn::Load(d32, limits)));
  const auto hit1 = hn::Gt(dots1, hn::Min(limit, hn::Load(d32, limits + hn::Lanes(d32))));
  return HWY_UNLIKELY(!hn::AllFalse(d32, hn::Or(hit0, hit1)));
}

// All queries against one group. queries: kNumPairs numbers of 2 x 16 bits each; their number is
// rounded up to whole kNumQueries.
void MatchGroup(const int32_t* queries, size_t count, const Group& group, NearestRecord* record) {
  const D32 d32;
  const D16 d16;
  const size_t num_lanes = hn::Lanes(d32);
  HWY_ALIGN int32_t dots[2 * hn::MaxLanes(d32)];
  for (size_t i = 0; i < count; i += kNumQueries) {
    const int32_t* query = queries + i * kNumPairs;
    const int16_t* pairs = group.pairs;
    const V32 zero = hn::Zero(d32);
    V32 a0 = zero, a1 = zero, b0 = zero, b1 = zero, c0 = zero, c1 = zero, e0 = zero, e1 = zero;
    V32 p0 = zero, p1 = zero, q0 = zero, q1 = zero, r0 = zero, r1 = zero, s0 = zero, s1 = zero;
    for (size_t k = 0; k < kNumPairs; ++k, pairs += 4 * num_lanes) {
      const V16 train0 = hn::Load(d16, pairs), train1 = hn::Load(d16, pairs + 2 * num_lanes);
      const auto of = [&](size_t n) HWY_ATTR {
        return hn::BitCast(d16, hn::Set(d32, query[n * kNumPairs + k]));
      };
      const V16 a = of(0), b = of(1), c = of(2), e = of(3);
      a0 = hn::ReorderWidenMulAccumulate(d32, train0, a, a0, p0);
      a1 = hn::ReorderWidenMulAccumulate(d32, train1, a, a1, p1);
      b0 = hn::ReorderWidenMulAccumulate(d32, train0, b, b0, q0);
      b1 = hn::ReorderWidenMulAccumulate(d32, train1, b, b1, q1);
      c0 = hn::ReorderWidenMulAccumulate(d32, train0, c, c0, r0);
      c1 = hn::ReorderWidenMulAccumulate(d32, train1, c, c1, r1);
      e0 = hn::ReorderWidenMulAccumulate(d32, train0, e, e0, s0);
      e1 = hn::ReorderWidenMulAccumulate(d32, train1, e, e1, s1);
    }
    const auto finish = [&](size_t n, V32 sum0, V32 rest0, V32 sum1, V32 rest1) HWY_ATTR {
      if (i + n >= count) return;
      const V32 dots0 = hn::RearrangeToOddPlusEven(sum0, rest0);
      const V32 dots1 = hn::RearrangeToOddPlusEven(sum1, rest1);
      if (!CanMatter(dots0, dots1, -record->Bound1(i + n), group.limits)) return;
      hn::Store(dots0, d32, dots);
      hn::Store(dots1, d32, dots + num_lanes);
      EnterHits(dots, i + n, group, 2 * num_lanes, record);
    };
    finish(0, a0, p0, a1, p1);
    finish(1, b0, q0, b1, q1);
    finish(2, c0, r0, c1, r1);
    finish(3, e0, s0, e1, s1);
  }
}

NearestNeighbors FindNearest(const std::vector<SiftDescriptor>& descriptors1,
                             const std::vector<SiftDescriptor>& descriptors2, int cap,
                             bool with_second) {
  const size_t count1 = descriptors1.size(), count2 = descriptors2.size();
  NearestRecord record(count1, count2, cap, with_second);
  std::vector<int32_t> queries((count1 + kNumQueries) * kNumPairs);
  for (size_t i = 0; i < count1; ++i) {
    for (size_t k = 0; k < kNumPairs; ++k) {
      const SiftDescriptor& descriptor = descriptors1[i];
      const int16_t pair[2] = {descriptor[2 * k], descriptor[2 * k + 1]};
      hwy::CopyBytes<sizeof(pair)>(pair, &queries[i * kNumPairs + k]);
    }
  }
  const size_t group_size = 2 * hn::Lanes(D32());
  const auto pairs = hwy::AllocateAligned<int16_t>(kNumPairs * group_size * 2);
  const auto limits = hwy::AllocateAligned<int32_t>(group_size);
  for (size_t begin = 0; begin < count2; begin += group_size) {
    for (size_t lane = 0; lane < group_size; ++lane) {
      const size_t j = HWY_MIN(begin + lane, count2 - 1);
      for (size_t k = 0; k < 2 * kNumPairs; ++k) {
        pairs[(k / 2 * group_size + lane) * 2 + k % 2] = descriptors2[j][k];
      }
      limits[lane] = -record.Bound2(j);
    }
    MatchGroup(queries.data(), count1, {pairs.get(), limits.get(), begin, count2}, &record);
  }
  return record.Take();
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace sift
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace sift {

HWY_EXPORT(FindNearest);

NearestNeighbors FindNearest(const std::vector<SiftDescriptor>& descriptors1,
                             const std::vector<SiftDescriptor>& descriptors2, int cap,
                             bool with_second) {
  return HWY_DYNAMIC_DISPATCH(FindNearest)(descriptors1, descriptors2, cap, with_second);
}

}  // namespace sift
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
