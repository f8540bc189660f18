// The kernels that have no test of their own through what calls them, against plain definitions,
// with every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <random>
#include <vector>

#include "feature/kernels/bit_kernels.h"
#include "feature/kernels/contrast_kernels.h"
#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidths[] = {1, 2, 7, 15, 16, 17, 31, 33, 64, 65, 130, 257};

template <typename T>
std::vector<T> RandomRow(size_t width, int end, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<T> row(width);
  for (T& value : row) value = static_cast<T>(random() % static_cast<unsigned>(end));
  return row;
}

// `out` is one element too long, which must stay as it is.
template <typename T, typename Kernel>
std::vector<T> Row(int width, const Kernel& kernel) {
  std::vector<T> out(static_cast<size_t>(width) + 1, T{99});
  kernel(out.data());
  EXPECT_EQ(out.back(), T{99});
  out.pop_back();
  return out;
}

TEST(ContrastKernels, SmoothDownIsThreeBoxesOfFive) {
  constexpr int kTaps[] = {1, 3, 6, 10, 15, 18, 19, 18, 15, 10, 6, 3, 1};
  for (const int width : kWidths) {
    std::vector<std::vector<uint8_t>> rows;
    std::array<const uint8_t*, contrast::kNumTaps> pointers;
    for (unsigned t = 0; t < contrast::kNumTaps; ++t) {
      // In the first column the largest sum there can be.
      rows.push_back(RandomRow<uint8_t>(static_cast<size_t>(width), 256, t));
      rows.back()[0] = 255;
    }
    for (size_t t = 0; t < rows.size(); ++t) pointers[t] = rows[t].data();
    std::vector<uint16_t> expected;
    for (size_t x = 0; x < static_cast<size_t>(width); ++x) {
      int sum = 0;
      for (size_t t = 0; t < rows.size(); ++t) sum += kTaps[t] * rows[t][x];
      expected.push_back(static_cast<uint16_t>(sum));
    }
    ForEachVectorTarget([&] {
      EXPECT_EQ(
          Row<uint16_t>(width, [&](auto* out) { contrast::SmoothDown(pointers, width, out); }),
          expected);
    });
  }
}

TEST(ContrastKernels, BoxAcrossAndShift) {
  for (const int width : kWidths) {
    const auto in = RandomRow<uint16_t>(static_cast<size_t>(width) + 4, 125 * 255 + 1, 3);
    std::vector<uint16_t> boxes, shifted;
    for (size_t x = 0; x < static_cast<size_t>(width); ++x) {
      int sum = 0;
      for (size_t u = x; u < x + 5; ++u) sum += in[u] / 4;
      boxes.push_back(static_cast<uint16_t>(sum));
      shifted.push_back(static_cast<uint16_t>((in[x] + 8) / 16));
    }
    ForEachVectorTarget([&] {
      EXPECT_EQ(
          Row<uint16_t>(width, [&](auto* out) { contrast::BoxAcross(in.data(), width, out); }),
          boxes);
      EXPECT_EQ(Row<uint16_t>(width, [&](auto* out) { contrast::ShiftRow(in.data(), width, out); }),
                shifted);
    });
  }
}

TEST(ContrastKernels, SumsSlideAndMeansAreTakenOff) {
  for (const int width : kWidths) {
    const auto count = static_cast<size_t>(width);
    const auto entering = RandomRow<uint16_t>(count, 3892, 4);
    const auto leaving = RandomRow<uint16_t>(count, 3892, 5);
    const auto before = RandomRow<uint32_t>(count, 61 * 3891, 6);
    const auto smooth = RandomRow<uint16_t>(count, 3892, 7);
    const auto box_sums = RandomRow<uint32_t>(count, 61 * 61 * 3891, 8);
    std::vector<uint32_t> slid;
    std::vector<int16_t> less_mean;
    for (size_t x = 0; x < count; ++x) {
      slid.push_back(before[x] + 4000 + entering[x] - leaving[x]);
      const int mean = static_cast<int>(static_cast<float>(box_sums[x]) * (1.0f / 3721) + 0.5f);
      less_mean.push_back(static_cast<int16_t>(smooth[x] - mean));
    }
    ForEachVectorTarget([&] {
      EXPECT_EQ(Row<uint32_t>(width,
                              [&](auto* sums) {
                                for (size_t x = 0; x < count; ++x) sums[x] = before[x] + 4000;
                                contrast::SlideDown(entering.data(), leaving.data(), width, sums);
                              }),
                slid);
      EXPECT_EQ(Row<int16_t>(width,
                             [&](auto* out) {
                               contrast::SubtractMean(smooth.data(), box_sums.data(), width,
                                                      1.0f / 3721, out);
                             }),
                less_mean);
    });
  }
}

TEST(ContrastKernels, MeanOfPairs) {
  for (const int width : kWidths) {
    const auto above = RandomRow<uint8_t>(2 * static_cast<size_t>(width), 256, 9);
    const auto below = RandomRow<uint8_t>(2 * static_cast<size_t>(width), 256, 10);
    std::vector<uint8_t> expected;
    for (size_t x = 0; x < above.size(); x += 2) {
      const int sum = above[x] + above[x + 1] + below[x] + below[x + 1];
      expected.push_back(static_cast<uint8_t>((sum + 2) / 4));
    }
    ForEachVectorTarget([&] {
      EXPECT_EQ(Row<uint8_t>(width,
                             [&](auto* out) {
                               contrast::MeanOfPairs(above.data(), below.data(), width, out);
                             }),
                expected);
    });
  }
}

// As the index holds them: signatures with something else in between.
struct Entry {
  bits::Signature signature;
  uint32_t other;
};

TEST(BitKernels, FindNearIsTheDefinition) {
  std::mt19937 random(11);
  size_t total = 0;
  for (const size_t count : {0, 1, 2, 63, 500}) {
    bits::Signature query;
    for (uint32_t& word : query) word = static_cast<uint32_t>(random());
    std::vector<Entry> entries(count);
    for (Entry& entry : entries) {
      entry.signature = query;
      entry.other = static_cast<uint32_t>(random());
      for (unsigned flips = random() % 60; flips > 0; --flips) {
        entry.signature[random() % 3] ^= 1u << random() % 32;
      }
    }
    for (const int max_distance : {0, 20, 30, 96}) {
      std::vector<std::pair<uint32_t, int>> expected;
      for (uint32_t i = 0; i < count; ++i) {
        size_t distance = 0;
        for (size_t w = 0; w < 3; ++w) {
          distance += std::bitset<32>(query[w] ^ entries[i].signature[w]).count();
        }
        if (static_cast<int>(distance) <= max_distance) expected.emplace_back(i, distance);
      }
      total += expected.size();
      ForEachVectorTarget([&] {
        std::vector<bits::Near> found(count);
        found.resize(bits::FindNear(query, entries.empty() ? nullptr : &entries[0].signature,
                                    sizeof(Entry), count, max_distance, found.data()));
        ASSERT_EQ(found.size(), expected.size());
        for (size_t n = 0; n < found.size(); ++n) {
          EXPECT_EQ(std::pair(found[n].idx, found[n].distance), expected[n]);
        }
      });
    }
  }
  EXPECT_GT(total, 500u);
}

TEST(BitKernels, FindTwoNearestIsTheDefinition) {
  std::mt19937 random(12);
  for (int round = 0; round < 200; ++round) {
    std::vector<bits::WholeBits> all(1 + round % 9);
    for (bits::WholeBits& one : all) {
      one = all[0];  // some are alike
      for (unsigned flips = random() % 6; flips > 0; --flips) {
        one[random() % 4] ^= uint64_t{1} << random() % 64;
      }
    }
    const bits::WholeBits query = all.back();
    all.pop_back();
    std::vector<std::pair<int, uint32_t>> ranked = {{257, 0}, {257, 0}};
    for (uint32_t i = 0; i < all.size(); ++i) {
      int distance = 0;
      for (size_t w = 0; w < 4; ++w) {
        distance += static_cast<int>(std::bitset<64>(query[w] ^ all[i][w]).count());
      }
      ranked.emplace_back(distance, i);
    }
    std::sort(ranked.begin(), ranked.end());
    ForEachVectorTarget([&] {
      const bits::TwoNearest found = bits::FindTwoNearest(query, all.data(), all.size());
      EXPECT_EQ(std::pair(found.distance, found.nearest), ranked[0]);
      EXPECT_EQ(std::pair(found.second_distance, found.second), ranked[1]);
    });
  }
}

}  // namespace
}  // namespace colmap_seapoint
