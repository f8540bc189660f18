// How coarse the grid is on which matches grow (densify/match/propagation.h): kernels and matching
// share these two numbers and nothing else.
#pragma once

namespace colmap_seapoint {

// Pixels between nodes. Small steps are for pictures that are sampled densely.
inline constexpr int kMinNodeStep = 4, kMaxNodeStep = 8;

}  // namespace colmap_seapoint
