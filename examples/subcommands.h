// The command-line frame of the programs beside the main one: `<program> <command> --option value`.
// Help and results go to stdout, everything else to stderr.
#pragma once

#include <boost/program_options.hpp>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace colmap_seapoint {

// False when only help was asked for, which is printed then. Throws UsageError for unknown, missing
// and illegal options.
bool ParseOptions(const boost::program_options::options_description& description,
                  const std::vector<std::string>& arguments);

// An option whose default is the value that is there.
template <typename T>
boost::program_options::typed_value<T>* Default(T* value) {
  return boost::program_options::value<T>(value)->default_value(*value);
}

// Takes the arguments behind the command, returns the exit code.
using Subcommand = std::function<int(const std::vector<std::string>&)>;

// The whole of main(): exit code 0 done, 1 failed (Error and any other exception), 2 wrong usage.
// `usage`: lines of help, with newlines.
int RunSubcommands(int argc, char** argv, const std::string& program, const std::string& usage,
                   const std::map<std::string, Subcommand>& commands);

}  // namespace colmap_seapoint
