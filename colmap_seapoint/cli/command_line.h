// Command line and project file -> options; `-h`.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "colmap_seapoint/cli/command.h"

namespace colmap_seapoint {

// The option that every command takes besides its own.
inline constexpr char kProjectPath[] = "project_path";

// Sets the command's options from `--name value` arguments and from `--project_path file.ini`
// (COLMAP's layout: top-level keys, then [Group] sections); the command line wins. Keys of the file
// that belong to another command of ours are passed over, so that one file serves them all.
// Throws UsageError, one sentence with name, value and rule, for whatever is unknown, given twice,
// lacking or illegal; Error when the file cannot be read. Returns false, and sets nothing, when
// the arguments ask for help.
bool ParseCommandLine(const Command& command, const std::vector<std::string>& arguments,
                      OptionTable* table);

// What the first "--option list" or "--option help" asks for, of an option that has a listing; ""
// when none does. The other options need not be there, nor right.
std::string ListingAskedFor(const std::vector<std::string>& arguments, const OptionTable& table);

// What `-h` and the man page say of one option: what it is for, legal values, origin. One line.
std::string OptionHelp(const OptionInfo& option);

// Every option with default, unit, range and origin.
void PrintCommandHelp(const Command& command, const OptionTable& table, std::ostream& out);

}  // namespace colmap_seapoint
