// automatic_reconstructor: a folder of pictures -> SeaPoints -> matches -> colmap mapper -> dense
// clouds and maps. The same command again goes on where an interrupted run stopped.
#pragma once

#include <set>
#include <string>

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"

namespace colmap_seapoint {

// Throws UsageError and Error; what a stage has finished by then is kept.
CommandResult RunAutomaticReconstructor(const AutomaticReconstructorOptions& given);

// A round of a survey that is still being made (watch/): the same of these pictures alone, names
// below options.image_path of what COLMAP reads. A model that an earlier round made is added to,
// however few pictures it began with; what a run of all pictures makes afterwards is made anew.
// Nothing is learnt of the machine's pace.
RunReport ReconstructLive(const AutomaticReconstructorOptions& given,
                          const std::set<std::string>& pictures);

}  // namespace colmap_seapoint
