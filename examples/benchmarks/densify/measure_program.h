// The whole program against the floor that nobody gets below: decoding the pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "examples/benchmarks/densify/densify_rows.h"

namespace colmap_seapoint {

struct ProgramOptions {
  std::string set_name;
  std::filesystem::path binary;  // colmap_seapoint
  std::filesystem::path image_path, input_path;
  std::string database_path;           // or empty
  std::vector<std::string> arguments;  // further ones of partial_densifier
  int num_repeats = 3;                 // of both; the median counts
};

// Runs partial_densifier into a temporary folder, and decodes the model's pictures with cv::imread
// (IMREAD_COLOR) and with our own reader, one after the other on the caller's thread. CPU: user +
// sys. Throws Error when the program fails or a picture cannot be read.
ProgramRow MeasureProgram(const ProgramOptions& options);

}  // namespace colmap_seapoint
