// Where pictures were taken, as far as COLMAP's database knows.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// COLMAP's versions write three shapes: images.prior_tx and so on up to 3.9, then pose_priors by
// image, and from 4.0 on pose_priors by the data of frames. All are read.
struct PositionPrior {
  enum class System { kUnknown = -1, kGeographic = 0, kCartesian = 1 };  // COLMAP's numbers

  uint32_t image_id = 0;
  Eigen::Vector3d position;  // latitude, longitude (degrees), altitude (m); or x, y, z
  System system = System::kUnknown;
};

// Of the images that have one, by image_id; finite. A row of pose_priors wins over
// images.prior_*. Throws Error for a row of the wrong size.
std::vector<PositionPrior> ReadPositionPriors(const ColmapDatabase& database);

}  // namespace colmap_seapoint
