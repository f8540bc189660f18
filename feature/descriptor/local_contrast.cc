#include "feature/descriptor/local_contrast.h"

#include <algorithm>
#include <array>
#include <vector>

#include "colmap_seapoint/base/vector_clones.h"

namespace colmap_seapoint {

namespace {

constexpr int kRadius = 6;  // of the smoothing: three boxes of 5 after each other
constexpr size_t kNumTaps = 2 * kRadius + 1;

// Three boxes of 5 at once: at most 125 * 255. `out` overlaps none of the rows.
SEAPOINT_VECTOR_CLONES
void SmoothDown(const std::array<const uint8_t*, kNumTaps>& rows, int width,
                uint16_t* __restrict out) {
  const std::array<const uint8_t*, kNumTaps> r = rows;
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    const auto p0 = static_cast<uint16_t>(r[0][x] + r[12][x]);
    const auto p1 = static_cast<uint16_t>(r[1][x] + r[11][x]);
    const auto p2 = static_cast<uint16_t>(r[2][x] + r[10][x]);
    const auto p3 = static_cast<uint16_t>(r[3][x] + r[9][x]);
    const auto p4 = static_cast<uint16_t>(r[4][x] + r[8][x]);
    const auto p5 = static_cast<uint16_t>(r[5][x] + r[7][x]);
    const auto ends = static_cast<uint16_t>(p0 + 3 * p1 + 6 * p2);
    const auto middle = static_cast<uint16_t>(10 * p3 + 15 * p4 + 18 * p5 + 19 * r[6][x]);
    out[x] = static_cast<uint16_t>(ends + middle);
  }
}

// One box of 5: out[x] of in[x .. x + 4]. Shifted before, so that no sum exceeds 16 bits.
SEAPOINT_VECTOR_CLONES
void BoxAcross(const uint16_t* in, int width, uint16_t* out) {
  for (int x = 0; x < width; ++x) {
    const unsigned sum =
        (in[x] >> 2) + (in[x + 1] >> 2) + (in[x + 2] >> 2) + (in[x + 3] >> 2) + (in[x + 4] >> 2);
    out[x] = static_cast<uint16_t>(sum);
  }
}

SEAPOINT_VECTOR_CLONES
void ShiftRow(const uint16_t* in, int width, uint16_t* out) {
  for (int x = 0; x < width; ++x) out[x] = static_cast<uint16_t>((in[x] + 8u) >> 4);
}

SEAPOINT_VECTOR_CLONES
void SlideDown(const uint16_t* entering, const uint16_t* leaving, int width, uint32_t* sums) {
  for (int x = 0; x < width; ++x) sums[x] += static_cast<uint32_t>(entering[x] - leaving[x]);
}

SEAPOINT_VECTOR_CLONES
void MeanOfPairs(const uint8_t* above, const uint8_t* below, int width, uint8_t* __restrict out) {
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    const unsigned sum = above[2 * x] + above[2 * x + 1] + below[2 * x] + below[2 * x + 1];
    out[x] = static_cast<uint8_t>((sum + 2) >> 2);
  }
}

Image<uint16_t> Smooth(const GrayImage& picture) {
  Image<uint16_t> smooth(picture.width, picture.height);
  const auto width = static_cast<size_t>(picture.width);
  std::vector<uint16_t> row(width + 2 * kRadius), box(row.size());
  for (int y = 0; y < picture.height; ++y) {
    std::array<const uint8_t*, kNumTaps> rows;
    for (int t = 0; t < static_cast<int>(kNumTaps); ++t) {
      rows[static_cast<size_t>(t)] =
          picture.Row(std::clamp(y + t - kRadius, 0, picture.height - 1));
    }
    SmoothDown(rows, picture.width, row.data() + kRadius);
    std::fill_n(row.begin(), kRadius, row[kRadius]);
    std::fill_n(row.end() - kRadius, kRadius, row[width + kRadius - 1]);
    BoxAcross(row.data(), picture.width + 8, box.data());
    BoxAcross(box.data(), picture.width + 4, row.data());
    BoxAcross(row.data(), picture.width, box.data());
    ShiftRow(box.data(), picture.width, smooth.Row(y));
  }
  return smooth;
}

// The window of `length` places that lies within 0..size-1 and nearest to `center`: its first
// place.
int WindowBegin(int center, int length, int size) {
  return std::clamp(center - length / 2, 0, size - length);
}

// Sums of the box around every place of a row, the column sums being those of the box's rows: at
// most 61 * 61 * 3891, which a float holds exactly.
void BoxSums(const std::vector<uint32_t>& column_sums, int length, uint32_t* sums) {
  const int width = static_cast<int>(column_sums.size());
  const int first_move = length / 2 + 1, num_moves = width - length;
  uint32_t sum = 0;
  for (int x = 0; x < length; ++x) sum += column_sums[static_cast<size_t>(x)];
  std::fill(sums, sums + std::min(first_move, width), sum);
  for (int move = 0; move < num_moves; ++move) {
    sum += column_sums[static_cast<size_t>(move + length)] - column_sums[static_cast<size_t>(move)];
    sums[first_move + move] = sum;
  }
  std::fill(sums + std::min(first_move + num_moves, width), sums + width, sum);
}

SEAPOINT_VECTOR_CLONES
void SubtractMean(const uint16_t* smooth, const uint32_t* sums, int width, float inverse_size,
                  int16_t* out) {
  for (int x = 0; x < width; ++x) {
    const float mean = static_cast<float>(static_cast<int32_t>(sums[x])) * inverse_size + 0.5f;
    out[x] = static_cast<int16_t>(smooth[x] - static_cast<int32_t>(mean));
  }
}

}  // namespace

Image<int16_t> LocalContrast(const GrayImage& picture) {
  Image<int16_t> contrast(picture.width, picture.height);
  if (picture.Empty()) return contrast;
  const Image<uint16_t> smooth = Smooth(picture);
  const int length_x = std::min(2 * kContrastBoxRadius + 1, picture.width);
  const int length_y = std::min(2 * kContrastBoxRadius + 1, picture.height);
  const float inverse_size = 1.0f / static_cast<float>(length_x * length_y);
  const std::vector<uint16_t> nothing(static_cast<size_t>(picture.width), 0);
  std::vector<uint32_t> column_sums(static_cast<size_t>(picture.width), 0);
  std::vector<uint32_t> sums(column_sums.size());
  for (int y = 0; y < length_y; ++y) {
    SlideDown(smooth.Row(y), nothing.data(), picture.width, column_sums.data());
  }
  for (int y = 0, begin = 0; y < picture.height; ++y) {
    if (begin != WindowBegin(y, length_y, picture.height)) {
      SlideDown(smooth.Row(begin + length_y), smooth.Row(begin), picture.width, column_sums.data());
      ++begin;
    }
    BoxSums(column_sums, length_x, sums.data());
    SubtractMean(smooth.Row(y), sums.data(), picture.width, inverse_size, contrast.Row(y));
  }
  return contrast;
}

GrayImage HalfSize(const GrayImage& picture) {
  GrayImage half(picture.width / 2, picture.height / 2);
  for (int y = 0; y < half.height; ++y) {
    MeanOfPairs(picture.Row(2 * y), picture.Row(2 * y + 1), half.width, half.Row(y));
  }
  return half;
}

}  // namespace colmap_seapoint
