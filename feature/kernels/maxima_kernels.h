// The row kernels of FindLocalMaxima: vector code chosen at run time, the same result from every
// version. Rows of measures are readable for kRowSlack elements behind their end.
#pragma once

#include <cstddef>
#include <cstdint>

namespace colmap_seapoint {
namespace maxima {

// Columns in [begin, end) that are above 0, above the four neighbours before them in raster order
// and not below the four after them. Writes them to `columns`, ascending; it has room for half of
// [begin, end) and kRowSlack more. Returns their number.
size_t FindPeaks(const float* above, const float* here, const float* below, int begin, int end,
                 int32_t* columns);

// Keeps those of `columns` that are the greatest of their window, of equals the first in raster
// order. rows: the 2 radius + 1 rows of the windows, the columns' own in the middle; readable from
// `radius` elements before their begin. Returns the number kept.
size_t KeepGreatest(const float* const* rows, int radius, int32_t* columns, size_t num_columns);

}  // namespace maxima
}  // namespace colmap_seapoint
