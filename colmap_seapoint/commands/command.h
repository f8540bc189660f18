// A subcommand: what the command table of main.cc is made of.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// Options of a group that are not ours: kept as typed, for another program.
struct ForeignOptions {
  std::string group;                                     // "Mapper"; empty = none are taken
  std::map<std::string, std::string>* values = nullptr;  // "Mapper.min_model_size" -> "5"
};

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongUsage = 2, kIncomplete = 3 };

struct Command {
  std::string name;
  std::string summary;  // one line
  // Both work on the same options struct: bind() first, parse, then run().
  std::function<void(OptionTable*)> bind;
  std::function<ExitCode()> run;
  ForeignOptions foreign;
};

// In the order of the data. Every call gives commands with fresh options.
std::vector<Command> AllCommands();

// `Options` has Bind(OptionTable*); `run` validates, reads, calls a stage, writes and reports.
// `foreign_values`: the member that takes the options of `foreign_group`.
template <typename Options>
Command MakeCommand(const std::string& name, const std::string& summary,
                    ExitCode (*run)(const Options&), const std::string& foreign_group = "",
                    std::map<std::string, std::string> Options::*foreign_values = nullptr) {
  auto options = std::make_shared<Options>();
  Command command;
  command.name = name;
  command.summary = summary;
  command.bind = [options](OptionTable* table) { options->Bind(table); };
  command.run = [options, run] { return run(*options); };
  command.foreign.group = foreign_group;
  if (foreign_values != nullptr) command.foreign.values = &((*options).*foreign_values);
  return command;
}

}  // namespace colmap_seapoint
