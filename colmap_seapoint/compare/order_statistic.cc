#include "colmap_seapoint/compare/order_statistic.h"

#include <cstring>
#include <vector>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

// Doubles that are not negative are ordered as the integers that their bits spell: of these, digits
// of 22, 21 and 21 bits are found one after the other.
double KthSmallest(const TileStore& values, uint64_t k) {
  uint64_t settled = 0;
  int num_left = 64;
  for (const int digit_bits : {22, 21, 21}) {
    const int shift = num_left - digit_bits;
    std::vector<uint64_t> histogram(uint64_t{1} << digit_bits, 0);
    for (int tile = 0; tile < values.NumTiles(); ++tile) {
      for (const uint64_t bits : values.Read<uint64_t>(tile)) {
        if (num_left < 64 && bits >> num_left != settled) continue;
        ++histogram[(bits >> shift) & (histogram.size() - 1)];
      }
    }
    uint64_t digit = 0;
    while (digit + 1 < histogram.size() && k >= histogram[digit]) k -= histogram[digit++];
    SEAPOINT_CHECK(k < histogram[digit]);
    settled = settled << digit_bits | digit;
    num_left = shift;
  }
  double value;
  std::memcpy(&value, &settled, sizeof(value));
  return value;
}

}  // namespace colmap_seapoint
