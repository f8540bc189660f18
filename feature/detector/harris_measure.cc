#include "feature/detector/harris_measure.h"

#include <algorithm>

#include "colmap_seapoint/base/error.h"
#include "feature/detector/harris_rows.h"

namespace colmap_seapoint {

FloatImage HarrisMeasure(const GrayImage& picture, const HarrisOptions& options) {
  SEAPOINT_CHECK(options.window_size % 2 == 1 && options.window_size <= 11);
  FloatImage map(picture.width, picture.height);
  const int border = HarrisBorder(options);
  if (picture.width <= 2 * border || picture.height <= 2 * border) return map;
  HarrisRows rows(picture, options, border);
  PaddedRows<float> row(1, static_cast<size_t>(picture.width));
  for (int y = border; y < picture.height - border; ++y) {
    rows.Next(row.Row(0));
    std::copy(row.Row(0), row.Row(0) + picture.width, map.Row(y));
  }
  return map;
}

}  // namespace colmap_seapoint
