#include "densify/match/match_surface.h"

#include <algorithm>

#include "densify/match/confidence.h"
#include "densify/match/consistency.h"
#include "densify/match/further_views.h"
#include "densify/match/propagation.h"
#include "densify/match/refinement.h"

namespace colmap_seapoint {

namespace {

// Growth only has to find the surface, at every node: what is weak is judged when it is refined.
constexpr int kGrowthWindow = 7;      // pixels
constexpr float kGrowthZncc = 0.85f;  // of min_zncc
constexpr int kSmoothing = 4;         // pixels around a sample that its plane is fitted to
constexpr float kMaxSlope = 0.75f;    // pixels of disparity a pixel, on one surface

// Refinement follows the surface a little beyond the last nodes, so growth ends that much earlier.
int MaxGenerations(const PairPlan& plan) {
  return std::max(1, static_cast<int>(plan.growth / plan.node_step) - kMaxRefinementSpread);
}

}  // namespace

MatchedSurface MatchSurface(const PairPlan& plan, const RectPicture& picture1,
                            const RectPicture& picture2, const Gate& gate,
                            const std::vector<FurtherView>& further, const MatchOptions& options,
                            int num_threads) {
  PartialDisparity nodes =
      Propagate(picture1, picture2, gate, plan.seeds,
                {kGrowthWindow, kGrowthZncc * options.min_zncc, MaxGenerations(plan)}, num_threads);
  RemoveInconsistent(gate, &nodes);

  MatchedSurface matched;
  matched.num_failed_seeds = nodes.num_failed_seeds;
  matched.partial = Refine(picture1, picture2, gate, nodes,
                           {options.window_size, options.min_zncc, options.step}, num_threads);
  RemoveContradictions(gate, num_threads, &matched.partial);

  const int radius = std::max(2, kSmoothing / options.step);  // in samples
  if (!further.empty()) {
    const PartialSurface first = FitSurface(matched.partial, radius, kMaxSlope, num_threads);
    MeasureInFurtherViews(plan.geometry, picture1, first, further, num_threads, &matched.partial);
  }
  matched.surface = FitRoughSurface(matched.partial, radius, kMaxSlope, num_threads);
  AssessConfidence(plan.geometry, num_threads, &matched.surface);
  RemoveUnsure(plan.geometry, options.min_confidence, num_threads, &matched.surface);
  return matched;
}

}  // namespace colmap_seapoint
