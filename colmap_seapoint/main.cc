// The command table, the only catch of the program, and its exit codes.
#include <algorithm>
#include <exception>
#include <iostream>
#include <limits>
#include <new>
#include <string>
#include <variant>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/commands/command.h"
#include "colmap_seapoint/commands/command_line.h"
#include "colmap_seapoint/commands/manual.h"

namespace {

using namespace colmap_seapoint;

void PrintHelp(const std::vector<Command>& commands, std::ostream& out) {
  out << "colmap_seapoint " << SEAPOINT_VERSION
      << ": dense clouds from underwater pictures, an add-on to COLMAP\n\n"
      << "usage: colmap_seapoint <command> [--project_path FILE.ini] [--option value]...\n\n";
  size_t width = 0;
  for (const Command& command : commands) width = std::max(width, command.name.size());
  for (const Command& command : commands) {
    out << "  " << command.name << std::string(width + 2 - command.name.size(), ' ')
        << command.summary << "\n";
  }
  out << "\n'colmap_seapoint <command> -h' lists the options of a command.\n"
      << "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 done but some input was left out.\n";
}

// `help [--format text|man|bash]`. The last two are for the package: see manual.h.
int RunHelp(const std::vector<Command>& commands, const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    PrintHelp(commands, std::cout);
    return kDone;
  }
  const std::string format =
      arguments.size() == 2 && arguments[0] == "--format" ? arguments[1] : "";
  if (format == "text") {
    PrintHelp(commands, std::cout);
  } else if (format == "man") {
    PrintManPage(commands, std::cout);
  } else if (format == "bash") {
    PrintBashCompletion(commands, std::cout);
  } else {
    throw UsageError(
        "help takes --format text, man or bash; 'colmap_seapoint <command> -h' lists "
        "the options of a command");
  }
  return kDone;
}

int RunCommand(const Command& command, const std::vector<std::string>& arguments) {
  OptionTable table;
  command.bind(&table);
  if (!ParseCommandLine(command, arguments, &table)) {
    PrintCommandHelp(command, table, std::cout);
    return kDone;
  }
  SetLogLevel(static_cast<LogLevel>(*std::get<int*>(table.Find("log_level")->target)));
  return command.run();
}

int Run(const std::vector<std::string>& arguments) {
  const std::vector<Command> commands = AllCommands();
  if (arguments.empty()) {
    PrintHelp(commands, std::cerr);
    throw UsageError("no command is given");
  }
  const std::string& name = arguments.front();
  if (name == "help" || name == "-h" || name == "--help") {
    return RunHelp(commands, {arguments.begin() + 1, arguments.end()});
  }
  if (name == "version" || name == "--version") {
    std::cout << "colmap_seapoint " << SEAPOINT_VERSION << "\n";
    return kDone;
  }
  for (const Command& command : commands) {
    if (command.name == name) {
      return RunCommand(command, {arguments.begin() + 1, arguments.end()});
    }
  }
  throw UsageError("'" + name + "' is no command; 'colmap_seapoint help' lists them");
}

// Buffers of megabytes come and go. By default each would be fresh memory, zeroed by the system
// page by page and given back: what is freed is kept for the next one. Not so the largest, planes
// of pictures and clouds: what little stays between them would leave holes that the next one does
// not fit into, and memory would grow with the number of pictures.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kNotKept = 10'000'000;  // bytes
  mallopt(M_MMAP_THRESHOLD, kNotKept);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_ARENA_MAX, 1);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  KeepFreedMemory();
  try {
    return Run({argv + 1, argv + argc});
  } catch (const UsageError& error) {
    LogError(error.what());
    return kWrongUsage;
  } catch (const Error& error) {
    LogError(error.what());
  } catch (const std::bad_alloc&) {
    LogError("memory: not enough for this run; use fewer --num_threads or smaller pictures");
  } catch (const std::exception& error) {
    LogError(std::string("internal: ") + error.what() + "; please report this");
  }
  return kFailed;
}
