// Which clips a user gives, in the order in which they were taken.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

struct Clip {
  std::filesystem::path path;
  std::string name;    // below the folder that was given; of a single file, its own
  std::string prefix;  // of its frames' names: "<recording>/<clip>", '/' between folders
};

// One file, or the videos of a folder and its sub-folders (`names`, as in FolderListing), in the
// order in which a person counts. Cameras cut a long recording into chapters: GoPro's GX010123.MP4,
// GX020123.MP4 (or GOPR0123.MP4, GP010123.MP4) follow one another and share a recording, whose lens
// is one.
std::vector<Clip> OrderClips(const std::filesystem::path& folder, std::vector<std::string> names);

}  // namespace colmap_seapoint
