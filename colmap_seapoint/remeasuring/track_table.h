// The tracks of a model in dense numbers, and the picture that shows each of its points best.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

enum class ObservationRole {
  kReference,  // in the picture that shows the point best
  kOther,
  kTwice,     // its picture observes the point elsewhere too, and there nearer to where it should
  kPredicted  // nobody has seen it there yet
};

struct Observation {
  int point_idx;
  uint32_t point2D_idx;
  ObservationRole role;
};

struct TrackTable {
  std::vector<uint64_t> point3D_ids;                   // by point_idx
  std::vector<std::vector<Observation>> observations;  // by image_idx, in the order of the points
};

// Only what can be measured is in it: finite observations in front of their camera, of pictures and
// pairs of coordinates that the model has. The reference is the picture with the most pixels on
// the surface, the less the more its ray is turned from the mean of the point's rays: from
// there all others look most alike. It must hold a patch around the point; a point without such a
// picture, or seen by fewer than two, has no reference. `first_predicted`: RemeasuringOptions.
// 40 bytes an observation.
TrackTable MakeTrackTable(const SparseModel& model,
                          const std::map<uint32_t, size_t>& first_predicted);

}  // namespace colmap_seapoint
