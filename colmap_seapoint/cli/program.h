// The program as it is typed: a command's name and its arguments, to results on stdout.
#pragma once

#include <string>
#include <vector>

namespace colmap_seapoint {

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongUsage = 2, kIncomplete = 3 };

// `arguments` without the program's own name. Throws UsageError, Error, and whatever else ends a
// command: main() turns it into the last line and the exit code.
ExitCode RunProgram(const std::vector<std::string>& arguments);

}  // namespace colmap_seapoint
