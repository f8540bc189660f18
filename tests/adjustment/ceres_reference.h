// The same minimum by Ceres, for models of one camera with OPENCV's lens: the oracle of small
// problems.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// With soft L1 of `scale` pixels and no prior; half the sum of the loss, as BundleAdjustment::cost.
double AdjustByCeres(double scale, SparseModel* model);

}  // namespace colmap_seapoint
