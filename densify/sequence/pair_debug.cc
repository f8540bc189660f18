#include "densify/sequence/pair_debug.h"

namespace colmap_seapoint {

std::vector<Eigen::Vector2d> FailedSeeds(const PairInput& input, const PairResult& result) {
  constexpr float kHardlyFilled = 0.1f;
  std::vector<Eigen::Vector2d> failed;
  for (const PixelPair& seed : input.seeds) {
    const size_t cell = input.cells.IndexOf(seed.pixel1.x(), seed.pixel1.y());
    const bool done_before = (!input.closed.empty() && input.closed[cell] != 0) ||
                             (!input.covered_range.empty() && input.covered_range[cell] > 0);
    if (!done_before && result.filled[cell] < kHardlyFilled) failed.push_back(seed.pixel1);
  }
  return failed;
}

}  // namespace colmap_seapoint
