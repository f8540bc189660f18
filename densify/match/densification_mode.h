// How much of a pair is densified.
#pragma once

namespace colmap_seapoint {

enum class DensificationMode {
  kPartial,   // only what is new
  kComplete,  // all of picture 1: the paper's baseline (section 3)
};

}  // namespace colmap_seapoint
