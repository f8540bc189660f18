#include "colmap_seapoint/cli/command_line.h"

#include <algorithm>
#include <boost/program_options.hpp>
#include <map>
#include <ostream>
#include <set>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

namespace po = boost::program_options;
using OptionTexts = std::map<std::string, std::string>;

constexpr size_t kHelpWidth = 96;

bool IsForeign(const Command& command, const std::string& name) {
  const std::string& group = command.foreign.group;
  return !group.empty() && name.compare(0, group.size() + 1, group + ".") == 0;
}

// The name in "--name" or "--name=value"; empty for anything else.
std::string LongOptionName(const std::string& argument) {
  if (argument.compare(0, 2, "--") != 0) return "";
  return argument.substr(2, argument.find('=') - 2);
}

po::options_description Describe(const Command& command, const OptionTable& table,
                                 const std::vector<std::string>& arguments) {
  po::options_description description;
  description.add_options()("help,h", "")(kProjectPath, po::value<std::string>());
  for (const OptionInfo& option : table.Options()) {
    description.add_options()(option.name.c_str(), po::value<std::string>());
  }
  std::set<std::string> foreign;
  for (const std::string& argument : arguments) {
    const std::string name = LongOptionName(argument);
    if (IsForeign(command, name) && foreign.insert(name).second) {
      description.add_options()(name.c_str(), po::value<std::string>());
    }
  }
  return description;
}

[[noreturn]] void RefuseUnknown(const Command& command, const OptionTable& table,
                                const std::string& where, const std::string& name) {
  std::string nearest;
  size_t nearest_distance = 1 + name.size() / 3;
  for (const OptionInfo& option : table.Options()) {
    const size_t distance = EditDistance(name, option.name);
    if (distance >= nearest_distance) continue;
    nearest_distance = distance;
    nearest = option.name;
  }
  throw UsageError(where + name + ": " + command.name + " has no such option" +
                   (nearest.empty() ? "" : "; did you mean " + where + nearest + "?") +
                   " ('colmap_seapoint " + command.name + " -h' lists all)");
}

OptionTexts ParseArguments(const Command& command, const OptionTable& table,
                           const std::vector<std::string>& arguments) {
  OptionTexts texts;
  try {
    const auto style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    const po::options_description description = Describe(command, table, arguments);
    const auto parsed = po::command_line_parser(arguments).options(description).style(style).run();
    for (const auto& option : parsed.options) {
      if (option.position_key >= 0 || option.string_key.empty()) {
        throw UsageError("'" + (option.value.empty() ? std::string() : option.value.front()) +
                         "' stands alone; every value follows its --option");
      }
      const std::string value = option.value.empty() ? "" : option.value.front();
      if (!texts.emplace(option.string_key, value).second) {
        throw UsageError("--" + option.string_key + ": given twice");
      }
    }
  } catch (const po::unknown_option& error) {
    std::string name = error.get_option_name();
    name.erase(0, name.find_first_not_of('-'));
    RefuseUnknown(command, table, "--", name);
  } catch (const po::error& error) {
    throw UsageError(error.what());
  }
  return texts;
}

bool AnyCommandKnows(const std::string& name) {
  for (const Command& command : AllCommands()) {
    OptionTable table;
    command.bind(&table);
    if (table.Find(name) != nullptr || IsForeign(command, name)) return true;
  }
  return false;
}

OptionTexts ParseProjectFile(const Command& command, const OptionTable& table,
                             const std::string& path) {
  InputStream file(path);
  OptionTexts texts;
  try {
    const auto parsed = po::parse_config_file(file, po::options_description(), true);
    for (const auto& option : parsed.options) {
      const std::string& name = option.string_key;
      if (table.Find(name) == nullptr && !IsForeign(command, name)) {
        if (AnyCommandKnows(name)) continue;
        RefuseUnknown(command, table, path + ": ", name);
      }
      const std::string value = option.value.empty() ? "" : option.value.front();
      if (!texts.emplace(name, value).second) {
        throw UsageError(path + ": " + name + " is given twice");
      }
    }
  } catch (const po::error& error) {
    throw UsageError(path + ": " + error.what());
  }
  return texts;
}

std::string LegalValues(const OptionInfo& option) {
  if (std::holds_alternative<bool*>(option.target)) return "0 or 1";
  if (std::holds_alternative<std::string*>(option.target)) {
    std::string text;
    for (const std::string& choice : option.choices) text += (text.empty() ? "" : " | ") + choice;
    return text;
  }
  double lowest = option.min, highest = option.max;
  return OptionValueText(&lowest) + " to " + OptionValueText(&highest);
}

// Lines of at most kHelpWidth letters, broken at blanks, each indented.
void PrintWrapped(const std::string& text, std::ostream& out) {
  const std::string indent(8, ' ');
  std::istringstream words(text);
  std::string line = indent;
  for (std::string word; words >> word;) {
    if (line.size() > indent.size() && line.size() + 1 + word.size() > kHelpWidth) {
      out << line << "\n";
      line = indent;
    }
    line += (line.size() > indent.size() ? " " : "") + word;
  }
  out << line << "\n";
}

}  // namespace

std::string ListingAskedFor(const std::vector<std::string>& arguments, const OptionTable& table) {
  for (size_t i = 0; i < arguments.size(); ++i) {
    const OptionInfo* option = table.Find(LongOptionName(arguments[i]));
    if (option == nullptr || option->listing.empty()) continue;
    const size_t equals = arguments[i].find('=');
    const bool is_apart = equals == std::string::npos;
    if (is_apart && i + 1 == arguments.size()) continue;
    const std::string value = is_apart ? arguments[i + 1] : arguments[i].substr(equals + 1);
    if (value == "list" || value == "help") return option->listing;
  }
  return "";
}

bool ParseCommandLine(const Command& command, const std::vector<std::string>& arguments,
                      OptionTable* table) {
  OptionTexts texts = ParseArguments(command, *table, arguments);
  if (texts.count("help") > 0) return false;
  if (const auto project = texts.find(kProjectPath); project != texts.end()) {
    // insert() keeps what the command line gave.
    const OptionTexts from_file = ParseProjectFile(command, *table, project->second);
    texts.erase(project);
    texts.insert(from_file.begin(), from_file.end());
  }
  const auto set = [&](const std::string& name, const std::string& text) {
    if (table->Find(name) == nullptr) {
      (*command.foreign.values)[name] = text;
      return;
    }
    const std::string problem = table->Set(name, text);
    if (!problem.empty()) throw UsageError(problem);
  };
  if (command.preset) {
    for (const char* name : {kQualityOption, kCameraPresetOption}) {
      if (const auto preset = texts.find(name); preset != texts.end()) set(name, preset->second);
    }
    command.preset();
  }
  for (const auto& [name, text] : texts) set(name, text);
  const std::string problem = table->Check();
  if (!problem.empty()) throw UsageError(problem);
  return true;
}

std::string OptionHelp(const OptionInfo& option) {
  if (option.required) return option.help;
  const std::string legal = LegalValues(option);
  return option.help + (legal.empty() ? "" : "; " + legal) + "; " + option.origin;
}

void PrintCommandHelp(const Command& command, const OptionTable& table, std::ostream& out) {
  out << "colmap_seapoint " << command.name << ": " << command.summary << "\n\n"
      << "  -h [ --help ]\n"
      << "  --" << kProjectPath << " FILE.ini\n"
      << "        the same options from a file: top-level keys, then [Group] sections;\n"
      << "        a value on the command line wins\n";
  for (const OptionInfo& option : table.Options()) {
    out << "  --" << option.name;
    out << (option.required ? " (required)" : " (=" + option.default_value + ")") << "\n";
    PrintWrapped(OptionHelp(option), out);
  }
  if (!command.foreign.group.empty()) {
    out << "  --" << command.foreign.group << ".<option> VALUE\n";
    PrintWrapped(command.foreign.help, out);
  }
}

}  // namespace colmap_seapoint
