// A cloud that no map can be made of, as against a fault of the machine or of what was asked for.
#pragma once

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

// Its points make no surface, or lie so far apart that the map would be too large.
class NoMap : public Error {
 public:
  using Error::Error;
};

}  // namespace colmap_seapoint
