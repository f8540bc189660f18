// automatic_reconstructor: a folder of pictures -> SeaPoints -> matches -> colmap mapper -> dense
// clouds and maps. The same command again goes on where an interrupted run stopped.
#pragma once

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"

namespace colmap_seapoint {

// Throws UsageError and Error; what a stage has finished by then is kept.
CommandResult RunAutomaticReconstructor(const AutomaticReconstructorOptions& given);

}  // namespace colmap_seapoint
