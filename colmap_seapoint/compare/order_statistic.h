// The k-th smallest of more numbers than fit in memory.
#pragma once

#include <cstdint>

#include "colmap_seapoint/io/cloud/tile_store.h"

namespace colmap_seapoint {

// `values`: doubles, none negative, none NaN; `k` from 0. Exact, by three readings of the store;
// 34 MB. The store must hold more than k values.
double KthSmallest(const TileStore& values, uint64_t k);

}  // namespace colmap_seapoint
