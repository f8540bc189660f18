// What the system said, as an Error of ours: where, what it was asked for, its own words, remedy.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

// "No space left on device"; safe on any thread.
std::string SystemText(int error_number);

// Error "<path>: <what> (<the system's words>); <what to do about this error number>".
Error SystemError(const std::filesystem::path& path, const std::string& what, int error_number);

// A file or folder that cannot be opened for reading, or not read to its end.
Error ReadError(const std::filesystem::path& path, int error_number);

}  // namespace colmap_seapoint
