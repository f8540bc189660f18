// The one median of the project, and its quantiles.
#pragma once

#include <algorithm>
#include <vector>

namespace colmap_seapoint {

// The median; the larger of the two in the middle when their number is even. Needs at least one
// value. Takes time linear in their number.
inline double UpperMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The value that this share of the others lies below, 0 to 1; of those there are, the next lower.
// As above.
inline double Quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace colmap_seapoint
