// The part of a model that pictures which came in since touch: COLMAP's mapper is given that alone,
// so that what they cost does not grow with the survey (ours).
#pragma once

#include <cstdint>
#include <set>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

using ImageIds = std::set<uint32_t>;

ImageIds IdsOf(const SparseModel& model);

// These pictures of a model, and the points that two of them see.
SparseModel PartOf(const SparseModel& whole, const ImageIds& images);

// What the mapper made of a part, in the whole that it is of: the pictures that are new, and what
// they see. A point of theirs that a feature of the whole has already is that one's, others follow
// under new ids. Nothing else of the whole changes.
void PutPartBack(const SparseModel& part, const SparseModel& grown, SparseModel* whole);

}  // namespace colmap_seapoint
