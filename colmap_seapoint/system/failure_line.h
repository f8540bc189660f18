// The last line of a run that failed.
#pragma once

#include <exception>
#include <string>

namespace colmap_seapoint {

// What the user reads of an exception: of the system's failures (a disk, a limit of threads or of
// memory) what the system said and what to do; "internal ... please report this" is left for what
// only a mistake of ours can throw.
std::string FailureLine(const std::exception& error);

}  // namespace colmap_seapoint
