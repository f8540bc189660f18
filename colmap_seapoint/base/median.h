#pragma once

#include <algorithm>
#include <vector>

namespace colmap_seapoint {

// Of an even number of values the larger of the two in the middle. Needs at least one.
inline double UpperMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace colmap_seapoint
