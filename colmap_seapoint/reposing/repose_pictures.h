// Pictures that stand wrong in a model are posed again (ours).
//
// A mapper that adds thousands of pictures one after the other may put one of them half a metre off
// and tilt it until a few of its points fit: nothing looks at it again, and the cloud has a tear
// there. Its verified matches know better: most of them contradict the pose.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// Moves the misplaced pictures (match_agreement.h) to where their matches with the others' points
// put them, when that pose has at least 20 inliers, which are most of these matches and twice as
// many as the present pose has. What they observed is let go: triangulate the model anew
// afterwards. Observations must be the database's keypoints. Returns the names of the moved ones.
// Throws Error where the database cannot be read.
std::vector<std::string> ReposePictures(const ColmapDatabase& database, SparseModel* model);

}  // namespace colmap_seapoint
