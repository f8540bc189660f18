// The one median of the project.
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

}  // namespace colmap_seapoint
