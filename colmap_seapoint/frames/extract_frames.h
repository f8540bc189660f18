// A clip -> the frames that a reconstruction needs, as JPEGs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/frames/frame_options.h"
#include "colmap_seapoint/io/video/video_file.h"

namespace colmap_seapoint {

struct ExtractedFrame {
  std::string name;  // of the JPEG, below the folder of the pictures
  double seconds = 0;
  double overlap = 0;  // with the one before it; 0: a track begins here
  double sharpness = 0;
  std::string time;  // ISO 8601, as the camera's clock said; empty = unknown
};

struct ExtractedClip {
  std::vector<ExtractedFrame> frames;
  int64_t num_frames = 0;  // of the clip
  double seconds = 0;      // from its first frame to its last
  bool is_interlaced = false;
  std::string shortfall;  // what of the clip could not be read, as words; empty = nothing
};

// Writes <images>/<prefix>_<index of the frame, six digits>.jpg, with EXIF where the container
// tells a time or a camera; creates folders. `label` is the clip's name for the progress, and
// `begin` is called with each name before its file is begun. Memory: a few frames, however long the
// video is. Throws Error when a file cannot be written.
ExtractedClip ExtractFrames(VideoFile* video, const std::string& label,
                            const std::filesystem::path& images, const std::string& prefix,
                            const FrameSelectionOptions& options,
                            const std::function<void(const std::string&)>& begin);

}  // namespace colmap_seapoint
