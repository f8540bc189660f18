// The similarity between two models that most of their links agree on (ours).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/joining/model_links.h"

namespace colmap_seapoint {

struct LinkConsensus {
  Similarity3d b_from_a;
  std::vector<size_t> inliers;  // of the links, ascending
  size_t num_rival_links = 0;   // that agree on another similarity instead
};

// Pixels that a link may be off in either picture, of so many pixels on its longer side: models
// that were adjusted apart disagree by more than their own errors.
double MaxLinkError(const Camera& camera);

// RANSAC over samples of three links, then least squares over those within MaxLinkError in both of
// their pictures; the rest of the links is searched once more for a rival, which there is where two
// places look alike. nullopt when fewer than 3 links agree, or only links along one line. The same
// every time: the samples are drawn from a fixed seed. Cost: 2000 projections a link.
std::optional<LinkConsensus> FindLinkConsensus(const SparseModel& a, const SparseModel& b,
                                               const std::vector<ModelLink>& links);

}  // namespace colmap_seapoint
