// The first stage of automatic_reconstructor: what a diver brings -> a folder of pictures that
// COLMAP and we read.
#pragma once

#include "colmap_seapoint/frames/frame_options.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

// Raise it whenever the same video and options give other frames than before.
inline constexpr char kFrameSelectionVersion[] = "1";

// What is to be taken in: seconds of video, or copies; and how many pictures there will be, and how
// large, by a guess: reading them tells. Nothing of what cannot be read, which TakeInPictures says.
struct IntakeSize {
  int64_t num_copies = 0, video_seconds = 0;
  double decoded_megapixels = 0;
  int64_t num_pictures = 0;
  double megapixels = 0;  // of all these pictures
};
IntakeSize ExpectIntake(const std::filesystem::path& given);

struct TakeInOptions {
  FrameSelectionOptions frames;
  int num_threads = -1;
};

// Looks at workspace->images, which is what the user gave:
//   a folder of pictures   is left as it is;
//   one with HEIC or RAW   becomes <workspace>/images: a JPEG <name>.jpg of each such picture, with
//                          its EXIF, and a link to each other one (a copy where the disk knows no
//                          links);
//   a video, or a folder   becomes <workspace>/images/<recording>/<clip>_<frame>.jpg, the frames
//   of clips alone         that a reconstruction needs, and frames.csv.
// workspace->images is that folder then. What an earlier run made of the same files is not made
// again; what it made of others is removed. What is not used is named in the report. Throws Error
// when nothing can be used.
void TakeInPictures(const TakeInOptions& options, Workspace* workspace, WorkspaceState* state,
                    RunReport* report);

}  // namespace colmap_seapoint
