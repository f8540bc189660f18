// The row kernels of HarrisRows: vector code chosen at run time, the same bits from every version.
//
// Number formats, all exact up to the last step:
//   picture                                   8 bits
//   smoothed vertically                      16 bits, 8 fractional; less 2^15, to fit int16
//   smoothed both ways                       12 bits, 4 fractional; at most 4080
//   gradients (central differences)          13 bits with sign
//   products, column sums, box sums          31 bits with sign: 11 * 11 * 4080^2 < 2^31
// Rows narrow at their left end as they are processed: index 0 is the first column that exists.
//
// Rows start at a cache line and have kRowSlack elements behind `width` (the picture's rows do
// not); what lies there is overwritten with anything, unless said otherwise.
#pragma once

#include <cstddef>
#include <cstdint>

namespace colmap_seapoint {
namespace harris {

// out[x] = sum of taps[t] * rows[t][x], less 2^15. The taps are symmetric and sum to 256.
void SmoothDown(const uint8_t* const* rows, const uint16_t* taps, int num_taps, size_t width,
                int16_t* out);

// out[x] = rounded weighted sum of in[x], in[x + 1], ... tap_pairs: two taps in an int32, the first
// one in the lower half; an odd number of taps is filled up with a tap of 0.
void SmoothAcross(const int16_t* in, const int32_t* tap_pairs, size_t num_pairs, size_t width,
                  int16_t* out);

// Adds one row's gradient products to the column sums and takes another's away. entering, leaving:
// the smoothed rows above, at and below each. sums: six rows, `stride` apart: xx of the even
// columns and of the odd ones, xy, yy.
void SlideSums(const int16_t* const* entering, const int16_t* const* leaving, size_t width,
               int32_t* sums, size_t stride);

// `width` measures of boxes of 2 radius + 1 columns; zeros behind them. extremes: the lowest and
// the highest so far.
void MeasureRow(const int32_t* sums, size_t stride, int radius, size_t width, float k, float* out,
                float* extremes);

}  // namespace harris
}  // namespace colmap_seapoint
