// The lens of a large survey, learnt from some of its pictures before all are posed (ours).
//
// While a model grows its distortion is held, or it would drift off (adjust_lens.h); a long survey
// that grows with a lens that is not its own comes out as a bowl of metres. Some 60 pictures that
// look at one another are posed first, and what their adjustment says of the lens is what all
// others grow with: on 1,000 pictures the mapper's camera centres are then 96 mm off instead of
// 4.3 m.
#pragma once

#include <map>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/mapping/mapper_process.h"

namespace colmap_seapoint {

// Fewer pictures than this are their own pilot.
inline constexpr size_t kMinPicturesOfPilot = 120;

// As OPENCV, with two focal lengths where the pictures prove them (lens/choose_lens.h): the rest of
// its form is chosen when all pictures have their say. The lenses, by camera_id, of the cameras
// that took the pilot's pictures; empty when no sound model came of them. `call`: as the whole
// survey will be mapped, in an empty folder of its own.
std::map<uint32_t, Camera> LearnLenses(const ColmapProgram& colmap, MapperCall call,
                                       bool frees_principal_point, int num_threads);

}  // namespace colmap_seapoint
