// A subcommand: what the command table is made of.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"

namespace colmap_seapoint {

// Whether an options struct has ForeignOptions Foreign().
template <typename Options, typename = void>
inline constexpr bool kTakesForeignOptions = false;
template <typename Options>
inline constexpr bool
    kTakesForeignOptions<Options, std::void_t<decltype(std::declval<Options>().Foreign())>> = true;

// Whether an options struct has void Preset().
template <typename Options, typename = void>
inline constexpr bool kHasPreset = false;
template <typename Options>
inline constexpr bool kHasPreset<Options, std::void_t<decltype(std::declval<Options>().Preset())>> =
    true;

struct Command {
  std::string name;
  std::string summary;  // one line
  // Both work on the same options struct: bind() first, parse, then run().
  std::function<void(OptionTable*)> bind;
  std::function<CommandResult()> run;
  // Called once kQualityOption and kCameraPresetOption are set and before the other options are:
  // sets the defaults that follow from them.
  std::function<void()> preset;
  ForeignOptions foreign;
};

// The commands in the order of the data. Every call gives them with fresh options.
std::vector<Command> AllCommands();

// `Options` has Bind(OptionTable*); `run` validates, reads, calls a stage, writes and reports.
template <typename Options>
Command MakeCommand(const std::string& name, const std::string& summary,
                    CommandResult (*run)(const Options&)) {
  auto options = std::make_shared<Options>();
  Command command;
  command.name = name;
  command.summary = summary;
  command.bind = [options](OptionTable* table) { options->Bind(table); };
  command.run = [options, run] { return run(*options); };
  if constexpr (kHasPreset<Options>) command.preset = [options] { options->Preset(); };
  if constexpr (kTakesForeignOptions<Options>) command.foreign = options->Foreign();
  return command;
}

}  // namespace colmap_seapoint
