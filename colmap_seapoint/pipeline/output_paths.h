// No output may be an input: what is to be read would be written over.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// Throws UsageError, naming both options, when the path of one that is an output leads to the same
// file or folder as that of another one, also through links (same_file.h).
void CheckOutputPaths(const OptionTable& table);

// Of everything that `options` binds: for a command's function to call before it reads anything.
// By value: Bind() wants an object to change.
template <typename Options>
void CheckOutputPaths(Options options) {
  OptionTable table;
  options.Bind(&table);
  CheckOutputPaths(static_cast<const OptionTable&>(table));
}

// Throws Error when a file that is no run.json of ours has the name of the one beside a database.
void CheckRunReport(const std::filesystem::path& path);

}  // namespace colmap_seapoint
