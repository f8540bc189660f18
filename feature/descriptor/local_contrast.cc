#include "feature/descriptor/local_contrast.h"

#include <algorithm>
#include <array>
#include <vector>

#include "feature/kernels/contrast_kernels.h"

namespace colmap_seapoint {

namespace {

constexpr int kRadius = contrast::kSmoothingRadius;

Image<uint16_t> Smooth(const GrayImage& picture) {
  Image<uint16_t> smooth(picture.width, picture.height);
  const auto width = static_cast<size_t>(picture.width);
  std::vector<uint16_t> row(width + 2 * kRadius), box(row.size());
  for (int y = 0; y < picture.height; ++y) {
    std::array<const uint8_t*, contrast::kNumTaps> rows;
    for (int t = 0; t < static_cast<int>(contrast::kNumTaps); ++t) {
      rows[static_cast<size_t>(t)] =
          picture.Row(std::clamp(y + t - kRadius, 0, picture.height - 1));
    }
    contrast::SmoothDown(rows, picture.width, row.data() + kRadius);
    std::fill_n(row.begin(), kRadius, row[kRadius]);
    std::fill_n(row.end() - kRadius, kRadius, row[width + kRadius - 1]);
    contrast::BoxAcross(row.data(), picture.width + 8, box.data());
    contrast::BoxAcross(box.data(), picture.width + 4, row.data());
    contrast::BoxAcross(row.data(), picture.width, box.data());
    contrast::ShiftRow(box.data(), picture.width, smooth.Row(y));
  }
  return smooth;
}

// The first place of the window of `length` places within 0..size-1 whose middle is nearest to
// `center`.
int WindowBegin(int center, int length, int size) {
  return std::clamp(center - length / 2, 0, size - length);
}

// The sums of the box around every place of a row, from the column sums of the box's rows. They are
// at most 61 * 61 * 3891, which a float holds exactly.
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
    contrast::SlideDown(smooth.Row(y), nothing.data(), picture.width, column_sums.data());
  }
  for (int y = 0, begin = 0; y < picture.height; ++y) {
    if (begin != WindowBegin(y, length_y, picture.height)) {
      contrast::SlideDown(smooth.Row(begin + length_y), smooth.Row(begin), picture.width,
                          column_sums.data());
      ++begin;
    }
    BoxSums(column_sums, length_x, sums.data());
    contrast::SubtractMean(smooth.Row(y), sums.data(), picture.width, inverse_size,
                           contrast.Row(y));
  }
  return contrast;
}

GrayImage HalfSize(const GrayImage& picture) {
  GrayImage half(picture.width / 2, picture.height / 2);
  for (int y = 0; y < half.height; ++y) {
    contrast::MeanOfPairs(picture.Row(2 * y), picture.Row(2 * y + 1), half.width, half.Row(y));
  }
  return half;
}

}  // namespace colmap_seapoint
