// Files of a random name that are to get their own name, or to vanish. Who writes one holds its
// lock, so that what a killed run left is told from what a living one is writing.
#pragma once

#include <filesystem>

namespace colmap_seapoint {

struct TemporaryFile {
  int descriptor = -1;  // for writing, locked; -1: it could not be created, and errno says why
  std::filesystem::path path;
};

// Creates ".seapoint_<16 hex digits>.tmp" in `folder`: never a file that was there, never through a
// link. Its lock ends with its descriptor: it is to be renamed or removed before that is closed.
TemporaryFile CreateTemporaryFile(const std::filesystem::path& folder);

// Removes from `folder` (not from folders below it) the temporary files that nobody holds: those of
// CreateTemporaryFile(), and the probes and tiles of earlier versions. On a file system without
// locks nothing is removed, since nothing is known. Cost: a listing of the folder.
void RemoveLeftovers(const std::filesystem::path& folder);

}  // namespace colmap_seapoint
