#include "feature/kernels/hamming_kernels.h"

#include <algorithm>
#include <cstring>

#include "hwy/aligned_allocator.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "feature/kernels/hamming_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

// How it works: the vectors hold one piece of many descriptors of the second set each, so that a
// lane adds up the distance of one descriptor and nothing has to be summed across lanes. A piece is
// a byte where the machine counts the bits of bytes; elsewhere it is four bits, and a byte shuffle
// looks up the distance of all sixteen from the query's four. Distances, clamped to a byte, are
// compared with the largest that could still change a nearest neighbour of either side. That
// happens a few times in a descriptor's life (ln n times on average for n in random order): what
// passes is computed again, exactly, and entered one by one.

// Shared by all versions.
#ifndef SEAPOINT_HAMMING_KERNELS_ONCE
#define SEAPOINT_HAMMING_KERNELS_ONCE
namespace colmap_seapoint {
namespace hamming {
namespace {

constexpr size_t kNumBytes = 32;  // of a descriptor

// Bits that differ between the numbers a and b of four bits each: at 16 a + b.
struct DistanceTable {
  alignas(16) uint8_t distance[256];
  constexpr DistanceTable() : distance() {
    for (int i = 0; i < 256; ++i) {
      for (int bits = (i / 16) ^ (i % 16); bits != 0; bits /= 2) {
        distance[i] = static_cast<uint8_t>(distance[i] + bits % 2);
      }
    }
  }
};
[[maybe_unused]] constexpr DistanceTable kDistanceTable;

int ExactDistance(const Descriptor& a, const Descriptor& b) {
  uint64_t words_a[4], words_b[4];
  std::memcpy(words_a, a.data(), kNumBytes);
  std::memcpy(words_b, b.data(), kNumBytes);
  int distance = 0;
  for (int i = 0; i < 4; ++i) distance += __builtin_popcountll(words_a[i] ^ words_b[i]);
  return distance;
}

// The record, by index. Limits: what a distance must be at most to matter, clamped to a byte.
class Search {
 public:
  Search(const std::vector<Descriptor>& descriptors1, const std::vector<Descriptor>& descriptors2,
         int cap, bool with_second)
      : descriptors1_(descriptors1),
        descriptors2_(descriptors2),
        record_(descriptors1.size(), descriptors2.size(), cap, with_second) {}

  uint8_t Limit1(size_t i) const { return Limit(record_.Bound1(i)); }
  uint8_t Limit2(size_t j) const { return Limit(record_.Bound2(j)); }
  void Enter(size_t i, size_t j) {
    record_.Enter(ExactDistance(descriptors1_[i], descriptors2_[j]), i, j);
  }
  NearestNeighbors Take() { return record_.Take(); }

 private:
  static uint8_t Limit(int bound) { return static_cast<uint8_t>(std::clamp(bound - 1, 0, 255)); }

  const std::vector<Descriptor>& descriptors1_;
  const std::vector<Descriptor>& descriptors2_;
  NearestRecord record_;
};

}  // namespace
}  // namespace hamming
}  // namespace colmap_seapoint
#endif  // SEAPOINT_HAMMING_KERNELS_ONCE

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace hamming {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

NearestNeighbors FindNearest(const std::vector<Descriptor>& descriptors1,
                             const std::vector<Descriptor>& descriptors2, int cap,
                             bool with_second) {
  return FindNearestOneByOne(descriptors1, descriptors2, cap, with_second, ExactDistance);
}

#else

using D8 = hn::ScalableTag<uint8_t>;
using V8 = hn::Vec<D8>;

// A group is as many descriptors of the second set as these vectors have lanes.
constexpr size_t kNumVectors = 4;

#if HWY_TARGET == HWY_AVX3_DL || HWY_ARCH_ARM  // count the bits of bytes in one step

constexpr size_t kNumPieces = kNumBytes;

uint8_t QueryPiece(const Descriptor& descriptor, size_t piece) { return descriptor[piece]; }
uint8_t TrainPiece(const Descriptor& descriptor, size_t piece) { return descriptor[piece]; }

HWY_INLINE V8 LoadQuery(const uint8_t* piece) { return hn::Set(D8(), *piece); }
HWY_INLINE V8 Distances(V8 query, V8 train) { return hn::PopulationCount(hn::Xor(query, train)); }

#else

constexpr size_t kNumPieces = 2 * kNumBytes;

uint8_t TrainPiece(const Descriptor& descriptor, size_t piece) {
  return static_cast<uint8_t>(descriptor[piece / 2] >> (piece % 2 * 4) & 15);
}
uint8_t QueryPiece(const Descriptor& descriptor, size_t piece) {  // where its table begins
  return static_cast<uint8_t>(16 * TrainPiece(descriptor, piece));
}

HWY_INLINE V8 LoadQuery(const uint8_t* piece) {
  return hn::LoadDup128(D8(), kDistanceTable.distance + *piece);
}
HWY_INLINE V8 Distances(V8 query, V8 train) { return hn::TableLookupBytes(query, train); }

#endif

// One group of the second set: pieces, limits, and where it begins.
struct Group {
  const uint8_t* pieces;  // kNumPieces times the group's lanes
  uint8_t* limits;        // of each lane
  size_t begin, end;
};

// Bit l of hits is set where lane l can change a nearest neighbour of either side.
HWY_INLINE bool FindHits(V8 d0, V8 d1, V8 d2, V8 d3, uint8_t query_limit, const uint8_t* limits,
                         uint64_t* hits) {
  const D8 d8;
  const size_t num_lanes = hn::Lanes(d8);
  const V8 limit = hn::Set(d8, query_limit);
  // a <= b as min(a, b) == a: unsigned comparisons are not everywhere.
  const auto is_hit = [&](V8 distance, size_t v) HWY_ATTR {
    const V8 largest = hn::Max(limit, hn::Load(d8, limits + v * num_lanes));
    return hn::Eq(hn::Min(distance, largest), distance);
  };
  const auto hit0 = is_hit(d0, 0), hit1 = is_hit(d1, 1), hit2 = is_hit(d2, 2), hit3 = is_hit(d3, 3);
  const auto any = hn::Or(hn::Or(hit0, hit1), hn::Or(hit2, hit3));
  if (HWY_LIKELY(hn::AllFalse(d8, any))) return false;
  uint8_t* bits = reinterpret_cast<uint8_t*>(hits);
  hn::StoreMaskBits(d8, hit0, bits);
  hn::StoreMaskBits(d8, hit1, bits + num_lanes / 8);
  hn::StoreMaskBits(d8, hit2, bits + num_lanes / 4);
  hn::StoreMaskBits(d8, hit3, bits + num_lanes / 8 * 3);
  return true;
}

HWY_NOINLINE void EnterHits(const uint64_t* hits, size_t num_words, size_t i, const Group& group,
                            Search* search) {
  for (size_t w = 0; w < num_words; ++w) {
    for (uint64_t word = hits[w]; word != 0; word &= word - 1) {
      const size_t lane = 64 * w + static_cast<size_t>(__builtin_ctzll(word));
      if (group.begin + lane >= group.end) return;
      search->Enter(i, group.begin + lane);
      group.limits[lane] = search->Limit2(group.begin + lane);
    }
  }
}

// All queries against one group, two at a time. queries: kNumPieces each; one more than `count`.
void MatchGroup(const uint8_t* queries, size_t count, const Group& group, Search* search) {
  const D8 d8;
  const size_t num_lanes = hn::Lanes(d8);
  const size_t num_words = kNumVectors * num_lanes / 64;
  uint64_t hits[kNumVectors * hn::MaxLanes(d8) / 64 + 1];
  for (size_t i = 0; i < count; i += 2) {
    const uint8_t* query = queries + i * kNumPieces;
    const uint8_t* train = group.pieces;
    V8 p0 = hn::Zero(d8), p1 = p0, p2 = p0, p3 = p0, q0 = p0, q1 = p0, q2 = p0, q3 = p0;
    for (size_t piece = 0; piece < kNumPieces; ++piece, train += kNumVectors * num_lanes) {
      const V8 p = LoadQuery(query + piece), q = LoadQuery(query + kNumPieces + piece);
      const V8 t0 = hn::Load(d8, train), t1 = hn::Load(d8, train + num_lanes);
      const V8 t2 = hn::Load(d8, train + 2 * num_lanes), t3 = hn::Load(d8, train + 3 * num_lanes);
      p0 = hn::SaturatedAdd(p0, Distances(p, t0));
      p1 = hn::SaturatedAdd(p1, Distances(p, t1));
      p2 = hn::SaturatedAdd(p2, Distances(p, t2));
      p3 = hn::SaturatedAdd(p3, Distances(p, t3));
      q0 = hn::SaturatedAdd(q0, Distances(q, t0));
      q1 = hn::SaturatedAdd(q1, Distances(q, t1));
      q2 = hn::SaturatedAdd(q2, Distances(q, t2));
      q3 = hn::SaturatedAdd(q3, Distances(q, t3));
    }
    if (FindHits(p0, p1, p2, p3, search->Limit1(i), group.limits, hits)) {
      EnterHits(hits, num_words, i, group, search);
    }
    if (i + 1 < count && FindHits(q0, q1, q2, q3, search->Limit1(i + 1), group.limits, hits)) {
      EnterHits(hits, num_words, i + 1, group, search);
    }
  }
}

NearestNeighbors FindNearest(const std::vector<Descriptor>& descriptors1,
                             const std::vector<Descriptor>& descriptors2, int cap,
                             bool with_second) {
  Search search(descriptors1, descriptors2, cap, with_second);
  const size_t count1 = descriptors1.size(), count2 = descriptors2.size();
  std::vector<uint8_t> queries((count1 + 1) * kNumPieces);
  for (size_t i = 0; i < count1; ++i) {
    for (size_t piece = 0; piece < kNumPieces; ++piece) {
      queries[i * kNumPieces + piece] = QueryPiece(descriptors1[i], piece);
    }
  }
  const size_t group_size = kNumVectors * hn::Lanes(D8());
  const auto pieces = hwy::AllocateAligned<uint8_t>(kNumPieces * group_size);
  const auto limits = hwy::AllocateAligned<uint8_t>(group_size);
  for (size_t begin = 0; begin < count2; begin += group_size) {
    for (size_t lane = 0; lane < group_size; ++lane) {
      const size_t j = HWY_MIN(begin + lane, count2 - 1);
      for (size_t piece = 0; piece < kNumPieces; ++piece) {
        pieces[piece * group_size + lane] = TrainPiece(descriptors2[j], piece);
      }
      limits[lane] = search.Limit2(j);
    }
    MatchGroup(queries.data(), count1, {pieces.get(), limits.get(), begin, count2}, &search);
  }
  return search.Take();
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace hamming
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace hamming {

HWY_EXPORT(FindNearest);

NearestNeighbors FindNearest(const std::vector<Descriptor>& descriptors1,
                             const std::vector<Descriptor>& descriptors2, int cap,
                             bool with_second) {
  return HWY_DYNAMIC_DISPATCH(FindNearest)(descriptors1, descriptors2, cap, with_second);
}

}  // namespace hamming
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
