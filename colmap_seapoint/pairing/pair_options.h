// What a user may set of the choice of pairs; the ranges stand in the .cc file, where each field is
// bound to its option.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

struct SequentialPairOptions {
  int overlap = 5;                     // following pictures that each one is matched with
  bool loop_detection = true;          // also with those that look like it, wherever they are
  int loop_detection_num_images = 10;  // looked for among so many, at most

  void Bind(OptionTable* table);
};

struct SpatialPairOptions {
  int max_num_neighbors = 20;  // nearest pictures that each one is matched with
  double max_distance = 100;   // of such a picture, metres
  bool ignore_z = true;        // heights do not count
  bool is_gps = true;          // priors of unknown kind are latitude, longitude, altitude
  std::string positions_path;  // CSV of positions; empty = EXIF, or the database

  void Bind(OptionTable* table);
};

}  // namespace colmap_seapoint
