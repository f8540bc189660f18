#include "examples/subcommands.h"

#include <exception>
#include <iostream>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;

int Run(const std::vector<std::string>& arguments, const std::string& usage,
        const std::map<std::string, Subcommand>& commands) {
  const std::string name = arguments.empty() ? "" : arguments[0];
  if (name == "-h" || name == "--help" || name == "help") {
    std::cout << usage;
    return 0;
  }
  const auto command = commands.find(name);
  if (command == commands.end()) {
    throw UsageError(name.empty() ? "no command given" : "unknown command '" + name + "'");
  }
  return command->second(std::vector<std::string>(arguments.begin() + 1, arguments.end()));
}

}  // namespace

bool ParseOptions(const po::options_description& description,
                  const std::vector<std::string>& arguments) {
  po::variables_map values;
  try {
    po::store(
        po::command_line_parser(arguments)
            .options(description)
            .positional({})
            .style(po::command_line_style::default_style & ~po::command_line_style::allow_guessing)
            .run(),
        values);
    if (values.count("help") > 0) {
      std::cout << description;
      return false;
    }
    po::notify(values);
  } catch (const po::error& e) {
    throw UsageError(e.what());
  }
  return true;
}

int RunSubcommands(int argc, char** argv, const std::string& program, const std::string& usage,
                   const std::map<std::string, Subcommand>& commands) {
  try {
    return Run(std::vector<std::string>(argv + 1, argv + argc), usage, commands);
  } catch (const UsageError& e) {
    std::cerr << usage << program << ": " << e.what() << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << program << ": " << e.what() << "\n";
    return 1;
  }
}

}  // namespace colmap_seapoint
