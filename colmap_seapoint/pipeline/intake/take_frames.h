// Clips -> the frames that a reconstruction needs, each clip once.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/frames/frame_options.h"
#include "colmap_seapoint/frames/list_clips.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/workspace/stage_runner.h"

namespace colmap_seapoint {

// Writes the frames of the clips and frames.csv into the folder, a stage "frames_<k>" a clip: a
// clip that was done is known by its size and samples of its content (HashSamplesOfFile), since
// clips are of gigabytes. Returns the names of the files. Clips that cannot be read are left out.
// Throws Error when no clip gives a frame.
std::set<std::string> TakeFrames(const std::vector<Clip>& clips,
                                 const FrameSelectionOptions& options, int num_threads,
                                 OutputFolder* folder, WorkspaceState* state, RunReport* report);

}  // namespace colmap_seapoint
