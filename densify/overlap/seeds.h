// From labelled SeaPoints to seeds (paper 2.6).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "densify/match/view.h"
#include "densify/overlap/influence_mask.h"

namespace colmap_seapoint {

// The intrapair matches whose SeaPoint of picture 1 lies outside the overlap area; without labels
// all of them.
std::vector<PixelPair> SeedsFromMatches(const std::vector<SeaPoint>& points1,
                                        const std::vector<SeaPoint>& points2,
                                        const FeatureMatches& matches,
                                        const std::vector<SeaPointLabel>& labels1);

// Ours: the triangulated points of picture 1 that project into both pictures, whichever pictures
// they were matched in. Their projections obey the poses exactly. `image1` is view1's.
std::vector<PixelPair> SeedsFromModel(const SparseModel& model, const PosedImage& image1,
                                      const View& view1, const View& view2);

}  // namespace colmap_seapoint
