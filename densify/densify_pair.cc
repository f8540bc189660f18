#include "densify/densify_pair.h"

#include <utility>

#include "colmap_seapoint/base/timer.h"
#include "densify/cloud/disparity_to_cloud.h"
#include "densify/match/hidden_samples.h"
#include "densify/match/match_surface.h"
#include "densify/match/rectify_pair.h"

namespace colmap_seapoint {

namespace {

MatchOptions MatchOptionsOf(const PartialDensificationOptions& options, const Camera& camera1) {
  return {SampleStep(camera1, options.step), options.window_size,
          static_cast<float>(options.min_zncc), options.max_expansion,
          static_cast<float>(options.min_confidence)};
}

// Reprojection, and what the cloud adds to picture 1 and to the survey.
PairResult Reproject(const PairInput& input, const PairPlan& plan, const RectifiedPair& rectified,
                     MatchedSurface matched, int num_threads) {
  PairResult result;
  result.cloud = MakePartialCloud(matched.surface, plan.geometry, rectified.map1, *input.picture1,
                                  num_threads);
  result.cloud.image_idx1 = input.view1.image_idx;
  result.cloud.image_idx2 = input.view2.image_idx;
  CellTally tally = TallyCells(matched.surface, plan.geometry, rectified.gate.Nodes(),
                               rectified.cell_of_node, input.known);
  result.filled = std::move(tally.filled);
  result.footprint = std::move(tally.footprint);
  result.partial = std::move(matched.partial);
  result.num_seeds = static_cast<int>(plan.seeds.size());
  result.num_failed_seeds = matched.num_failed_seeds;
  return result;
}

PairResult Failed(const std::string& why) {
  PairResult result;
  result.failure = why;
  return result;
}

}  // namespace

PairResult DensifyPair(const PairInput& input, const PartialDensificationOptions& options,
                       int num_threads) {
  const MatchOptions matching = MatchOptionsOf(options, input.view1.camera);
  const Timer rectification_timer;
  const PairPlan plan = PlanPair(input, matching);
  if (!plan.failure.empty()) return Failed(plan.failure);
  const RectifiedPair rectified = RectifyPair(input, plan, num_threads);
  const double rectification_seconds = rectification_timer.WallSeconds();

  const Timer propagation_timer;
  MatchedSurface matched = MatchSurface(plan, rectified.picture1, rectified.picture2,
                                        rectified.gate, input.further, matching, num_threads);
  RemoveHidden(&input.picture1->mask, input.mask2, input.view2, plan.geometry, rectified.map1,
               num_threads, &matched.surface);
  const double propagation_seconds = propagation_timer.WallSeconds();

  PairResult result = Reproject(input, plan, rectified, std::move(matched), num_threads);
  result.rectification_seconds = rectification_seconds;
  result.propagation_seconds = propagation_seconds;
  return result;
}

}  // namespace colmap_seapoint
