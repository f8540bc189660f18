// All options of all commands, each once: what the man page and the reference in Markdown say.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/cli/command.h"

namespace colmap_seapoint {

struct OptionEntry {
  OptionInfo option;
  std::vector<std::string> commands;  // that take it, in the order of the table

  bool IsInGroup() const { return option.name.find('.') != std::string::npos; }
};

// Options that the same commands take.
struct SharedOptions {
  std::vector<std::string> commands;
  std::vector<OptionEntry> entries;
};

struct OptionReference {
  std::vector<std::vector<OptionEntry>> own;  // by command: what it does not share as a group
  std::vector<SharedOptions> shared;          // groups, and what every command takes
};

// Every command's options, in the order of the commands. An option that reads differently in
// another command is listed there once more. `commands` outlives the result.
OptionReference MakeOptionReference(const std::vector<Command>& commands);

}  // namespace colmap_seapoint
