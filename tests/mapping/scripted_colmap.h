// A stand-in for COLMAP whose answers a test writes down beforehand, call by call.
//
// tests/cli/fake_colmap.cc speaks of one database and a handful of modes; here a test says what the
// n-th call of a command leaves, and reads with which arguments it was made.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

// What "mapper -h" prints: the first lines of COLMAP's own, with these option names.
std::string MapperHelp(const std::string& version, const std::vector<std::string>& names);

class ScriptedColmap {
 public:
  // Writes an executable `folder`/colmap, which knows the mapper's options of COLMAP 3.8.
  explicit ScriptedColmap(const std::filesystem::path& folder);

  const std::filesystem::path& Path() const { return path_; }
  // As FindColmap finds it.
  ColmapProgram Program() const;

  // What the program answers: to "mapper -h", "help", "global_mapper -h".
  void SetHelp(const std::string& mapper_help, const std::string& help = "",
               const std::string& global_mapper_help = "");

  // The n-th call (from 1) of a command leaves `model` in <output_path>/<name>; may be called more
  // than once. Without any, a mapper leaves nothing and a point_triangulator its input.
  void Leaves(const std::string& command, int call, const std::string& name,
              const SparseModel& model);
  // The n-th call of a command prints `text`, a line, and ends with this exit code.
  void Ends(const std::string& command, int call, const std::string& text, int exit_code);
  // The n-th call of a command ends by kill -9.
  void IsKilled(const std::string& command, int call);

  int NumCalls(const std::string& command) const;
  // All of a call's arguments, the command first.
  std::vector<std::string> Arguments(const std::string& command, int call) const;
  // The value of "--name" in a call; "" where it was not given.
  std::string Value(const std::string& command, int call, const std::string& name) const;
  // The lines of the file that --image_list_path named in a call, each with its newline.
  std::string ImageList(const std::string& command, int call) const;

 private:
  std::filesystem::path FileOf(const std::string& command, int call, const std::string& what) const;

  std::filesystem::path folder_, path_;
};

}  // namespace colmap_seapoint
