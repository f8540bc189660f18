// Between a picture's bytes and the light that they stand for (IEC 61966-2-1).
#pragma once

#include <cstdint>

namespace colmap_seapoint {

// 0 to 1, of a byte.
float LinearFromSrgb(uint8_t value);
// The nearest byte; what lies outside of 0 to 1 is cut, and NaN is 0. The way back of
// LinearFromSrgb(), exactly.
uint8_t SrgbFromLinear(float linear);

}  // namespace colmap_seapoint
