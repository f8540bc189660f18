// The files that each command writes into its output folder: what it claims before it writes. And
// that no output is an input: what is to be read would be written over.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// partial_densifier.
std::vector<std::string> CloudNames();
// The same with write_maps: what comes on top for these pictures.
std::vector<std::string> DenseMapNames(const std::vector<std::string>& pictures);
// model_scaler, without the cloud, which keeps its own name.
std::vector<std::string> ScaledModelNames();
// cloud_comparer, into --difference_path.
std::vector<std::string> DifferenceNames();

// The folder that the file lies in, also where its path names none.
std::filesystem::path FolderOf(const std::filesystem::path& file);

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
// What killed runs left beside it is removed.
void CheckRunReport(const std::filesystem::path& path);

}  // namespace colmap_seapoint
