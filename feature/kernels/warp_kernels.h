// The inner loops of MatchPatch (feature/remeasuring): a small window of a picture as a warp shows
// it, and sums over windows. Vector code chosen at run time; every version adds in the same order,
// so that the result is the same from all of them.
//
// A window reaches `reach` samples from its middle to all sides. Its rows are 2 reach + 2 long, a
// multiple of 8: the last column lies one sample further right, and only fills the vectors up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {
namespace warp {

inline constexpr int kReach = 7;   // of a patch
inline constexpr int kSearch = 4;  // how far from the predicted place it is searched for
inline constexpr int kWideReach = kReach + kSearch;
inline constexpr int kShifts = 2 * kSearch + 1;  // across, and down

constexpr int Stride(int reach) { return 2 * reach + 2; }
constexpr size_t WindowSize(int reach) {
  return static_cast<size_t>((2 * reach + 1) * Stride(reach));
}

using Patch = std::array<float, WindowSize(kReach)>;
using WholePatch = std::array<int16_t, WindowSize(kReach)>;
using WholeWindow = std::array<int16_t, WindowSize(kWideReach)>;

// Where a picture shows the window: sample (i, j) from the middle at x + i x_across + j x_down,
// ...; (0, 0) is the centre of the picture's first pixel.
struct Placement {
  double x, y;
  float x_across, y_across, x_down, y_down;
};

// Whether all samples, and what they are interpolated from, lie within the picture. False for
// numbers that are none.
bool IsInside(const GrayImage& picture, const Placement& placement, int reach);

// The grey values there by Keys' cubic convolution (a = -1/2), which hardly blurs: linear
// interpolation takes up to half of the finest detail away, by how far a sample lies from the next
// pixel, and pulls a match towards whole pixels. `out` has WindowSize(reach) elements. Needs
// IsInside. About 2.5 ns a sample.
void SampleWindow(const GrayImage& picture, const Placement& placement, int reach, float* out);

// Sums over a patch's pixels of a window that it is laid upon.
struct ShiftSums {
  int32_t other = 0, other_other = 0, patch_other = 0;
};

// For all shifts of the patch within the wider window, row by row. `patch` is 0 in its last column.
// About 3.5 microseconds.
void SumShifts(const WholePatch& patch, const WholeWindow& window,
               std::array<ShiftSums, kShifts * kShifts>* sums);

// The sum over all elements of a * b.
double Dot(const Patch& a, const Patch& b);

}  // namespace warp
}  // namespace colmap_seapoint
