// What ties two models of one survey (ours): points of both that are the same SeaPoint or that a
// verified match says are the same place.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {

// One match between a picture of `a` and one of `b`, both of whose SeaPoints are triangulated.
struct ModelLink {
  uint64_t point_a = 0, point_b = 0;          // ids in their models
  uint32_t image_idx_a = 0, image_idx_b = 0;  // in SparseModel::images
  Eigen::Vector2d pixel_a, pixel_b;           // where the pictures show the place
};

// The verified matches between the two models' pictures, and the pairs that were tried at all: of
// two pictures that nobody compared, no match says nothing.
struct ModelLinks {
  std::vector<ModelLink> links;  // by pair of image ids, then in the database's order
  std::set<ImagePair> tried;     // (image_id of a, image_id of b); not smaller first
};

// A picture that both models hold links its own SeaPoints. Features of the models are numbered as
// the database's keypoints, as COLMAP's mapper leaves them; numbers that a model does not have and
// points that it does not hold are passed over. Throws Error when the database cannot be read.
// Cost: one read for each pair between the models.
ModelLinks FindModelLinks(const ColmapDatabase& database, const SparseModel& a,
                          const SparseModel& b);

}  // namespace colmap_seapoint
