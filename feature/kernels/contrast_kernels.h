// The row kernels of LocalContrast and HalfSize: whole numbers, and one product and one sum in
// float, so every instruction set gives the same bits. Rows are `width` elements long and need no
// slack. `out` overlaps none of the other rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace colmap_seapoint {
namespace contrast {

inline constexpr int kSmoothingRadius = 6;  // three boxes of 5 after each other
inline constexpr size_t kNumTaps = 2 * kSmoothingRadius + 1;

// Three boxes of 5 down the column at once: out is 125 times the grey level at most.
void SmoothDown(const std::array<const uint8_t*, kNumTaps>& rows, int width, uint16_t* out);

// One box of 5: out[x] of in[x] .. in[x + 4], each divided by 4 before, so that no sum exceeds 16
// bits. `in` is width + 4 elements long.
void BoxAcross(const uint16_t* in, int width, uint16_t* out);

// out[x] = in[x] / 16, rounded.
void ShiftRow(const uint16_t* in, int width, uint16_t* out);

// Column sums: one row comes in, another goes out.
void SlideDown(const uint16_t* entering, const uint16_t* leaving, int width, uint32_t* sums);

// out[x] = smooth[x] less the mean, sums[x] * inverse_size, to the nearest whole number.
void SubtractMean(const uint16_t* smooth, const uint32_t* sums, int width, float inverse_size,
                  int16_t* out);

// out[x] = the rounded mean of columns 2 x and 2 x + 1 of both rows; these are 2 width long.
void MeanOfPairs(const uint8_t* above, const uint8_t* below, int width, uint8_t* out);

}  // namespace contrast
}  // namespace colmap_seapoint
