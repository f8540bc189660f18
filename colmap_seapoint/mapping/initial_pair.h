// The pair that a model begins with, where COLMAP would look for one in vain (ours).
//
// COLMAP begins with a pair of 100 matches that are seen from directions 16 degrees apart. Where a
// camera swims forward there is none; it then tries all pairs, asks for less, and tries them all
// again, and takes a poor one in the end: three minutes of CPU time for 53 frames of a video, and
// a focal length 40 % short.
#pragma once

#include <optional>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

struct InitialPair {
  uint32_t image_id1 = 0, image_id2 = 0;
  size_t num_inliers = 0;
  double angle_deg = 0;  // median over the inliers, by the pair's own geometry
};

// Of the pairs of at least 100 verified matches that are neither planar nor moved straight ahead,
// the one whose pictures see them from the most different directions. nullopt where there is none
// of more than half a degree, or where one reaches 8 degrees: COLMAP does well then. Cost: a ray an
// inlier, up to the first pair of 8 degrees. Throws Error when the database cannot be read.
std::optional<InitialPair> FindInitialPair(const ColmapDatabase& database);

// What a mapper is given to begin with that pair and to end with one model. nullopt when this
// COLMAP does not know the options, or the user has chosen a pair.
std::optional<MapperOptions> OptionsOfInitialPair(const ColmapProgram& colmap,
                                                  const MapperOptions& first_round,
                                                  const InitialPair& pair);

}  // namespace colmap_seapoint
