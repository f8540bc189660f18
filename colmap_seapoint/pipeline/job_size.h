// How large a job of automatic_reconstructor is, and what it will take of the machine: for the plan
// that its progress goes by, and for who wants to know before it begins (--estimate_only).
#pragma once

#include <filesystem>
#include <vector>

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/estimate/work_costs.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"

namespace colmap_seapoint {

// Whether every pair of so many pictures is tried.
bool MatchesAllPairs(const AutomaticReconstructorOptions& options, size_t num_pictures);

JobSize SizeOf(const AutomaticReconstructorOptions& options,
               const std::vector<ReadablePicture>& pictures);

// Before the pictures are read, and where they have to be made of something else first: by a guess
// (ExpectIntake). `given`: image_path.
JobSize SizeBeforeIntake(const AutomaticReconstructorOptions& options,
                         const std::filesystem::path& given);

// What the whole job will take, as one JSON object: pictures, megapixels, seconds (wall clock, on
// this machine, by its history), intake_seconds (of them, for videos and copies), disk_bytes,
// memory_bytes. Nothing is written, and what an earlier
// run has done is not counted off. Cost: the headers of the pictures are read. Throws Error where
// there is no picture and no video.
CommandResult EstimateJob(const AutomaticReconstructorOptions& options);

}  // namespace colmap_seapoint
