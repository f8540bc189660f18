// The loops of LumaOf and PictureOf over `count` pixels of red, green and blue: compiled for each
// instruction set and chosen at run time; whole numbers, so the same from every version.
#pragma once

#include <cstddef>
#include <cstdint>

namespace colmap_seapoint {
namespace picture {

// 0.299 red + 0.587 green + 0.114 blue, in 2^15ths, rounded.
void ToLuma(const uint8_t* rgb, size_t count, uint8_t* luma);

// Cb and Cr by JFIF, in 2^16ths, rounded; what would be 256 is 255.
void ToChroma(const uint8_t* rgb, size_t count, uint8_t* cb, uint8_t* cr);

}  // namespace picture
}  // namespace colmap_seapoint
