#include "colmap_seapoint/cli/manual.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/cli/command_line.h"
#include "colmap_seapoint/cli/option_reference.h"

namespace colmap_seapoint {
namespace {

// Roff reads '-' as a hyphen, and lines that begin with '.' or a quote as requests.
std::string Roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  if (!escaped.empty() && (escaped[0] == '.' || escaped[0] == '\'')) escaped = "\\&" + escaped;
  return escaped;
}

// Title and text of one option.
std::string RoffEntry(const OptionInfo& option) {
  std::string entry = ".TP\n\\fB\\-\\-" + Roff(option.name) + "\\fR ";
  entry += option.required ? "(required)" : "(=" + Roff(option.default_value) + ")";
  return entry + "\n" + Roff(OptionHelp(option)) + "\n";
}

std::string Names(const SharedOptions& shared, size_t num_commands) {
  if (shared.commands.size() == num_commands) return "every command";
  std::string names;
  for (const std::string& name : shared.commands) names += (names.empty() ? "" : ", ") + name;
  return names;
}

void PrintCommandSections(const std::vector<Command>& commands, const OptionReference& reference,
                          std::ostream& out) {
  for (size_t i = 0; i < commands.size(); ++i) {
    const Command& command = commands[i];
    out << ".SS " << Roff(command.name) << "\n" << Roff(command.summary) << "\n";
    for (const OptionEntry& entry : reference.own[i]) out << RoffEntry(entry.option);
    if (command.foreign.group.empty()) continue;
    out << ".TP\n\\fB\\-\\-" << Roff(command.foreign.group) << ".\\fR\\fIoption value\\fR\n"
        << Roff(command.foreign.help) << "\n";
  }
}

// Text of a table's cell.
std::string Cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

void PrintOptionRows(const std::vector<OptionEntry>& entries, std::ostream& out) {
  if (entries.empty()) return;
  out << "| option | default | what |\n|---|---|---|\n";
  for (const OptionEntry& entry : entries) {
    const OptionInfo& option = entry.option;
    const std::string value = option.default_value.empty() ? "" : "`" + option.default_value + "`";
    out << "| `--" << option.name << "` | " << (option.required ? "required" : value) << " | "
        << Cell(OptionHelp(option)) << " |\n";
  }
}

// The words as they stand within double quotes in the completion script.
std::string WordsText(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::vector<std::string> Values(const OptionInfo& option) {
  if (std::holds_alternative<bool*>(option.target)) return {"0", "1"};
  return option.choices;
}

// "    feature_extractor:--name) values='0 1' ;;", one line for every option with a fixed choice.
void PrintValueCases(const std::vector<Command>& commands, std::ostream& out) {
  std::map<std::string, std::string> patterns;  // values -> case pattern
  for (const Command& command : commands) {
    OptionTable table;
    command.bind(&table);
    for (const OptionInfo& option : table.Options()) {
      const std::string values = WordsText(Values(option));
      if (values.empty()) continue;
      std::string& pattern = patterns[values];
      pattern += (pattern.empty() ? "" : " |\\\n      ") + command.name + ":--" + option.name;
    }
  }
  for (const auto& [values, pattern] : patterns) {
    out << "    " << pattern << ")\n      values='" << values << "' ;;\n";
  }
}

void PrintOptionCases(const std::vector<Command>& commands, std::ostream& out) {
  for (const Command& command : commands) {
    OptionTable table;
    command.bind(&table);
    out << "    " << command.name << ")\n      options='-h --help --" << kProjectPath;
    for (const OptionInfo& option : table.Options()) out << "\n        --" << option.name;
    out << "' ;;\n";
  }
}

}  // namespace

void PrintManPage(const std::vector<Command>& commands, std::ostream& out) {
  out << ".\\\" Made by 'colmap_seapoint help --format man' from the program's option tables.\n"
      << ".TH COLMAP_SEAPOINT 1 \"\" \"colmap_seapoint " << Version() << "\" \"\"\n"
      << ".SH NAME\ncolmap_seapoint \\- dense clouds from underwater pictures, an add\\-on to "
         "COLMAP\n"
      << ".SH SYNOPSIS\n.B colmap_seapoint\n.I command\n[\\fB\\-\\-" << Roff(kProjectPath)
      << "\\fR \\fIfile.ini\\fR]\n[\\fB\\-\\-\\fIoption value\\fR]...\n.br\n"
      << ".B colmap_seapoint\n.I command\n.B \\-h\n.br\n"
      << ".B colmap_seapoint version\n.br\n"
      << ".B colmap_seapoint help\n[\\fB\\-\\-format\\fR "
         "\\fBtext\\fR|\\fBman\\fR|\\fBbash\\fR|\\fBmarkdown\\fR]\n"
      << ".SH DESCRIPTION\nTurns the photographs of a dive into one dense point cloud without\n"
      << "redundancy: SeaPoints and their matches go into a COLMAP database, poses come from the\n"
      << "unmodified\n.BR colmap (1)\nmapper, and then only what is new is densified, pair by pair "
         "along the track.\n"
      << ".PP\nNumbers in options are checked against the range that stands beside them. Behind\n"
      << "it stands where an option comes from: a section of the paper, COLMAP, or this program.\n"
      << ".PP\nA project file holds the same options: top\\-level keys, then [Group] sections. A\n"
      << "value on the command line wins.\n"
      << ".SH COMMANDS\n";
  const OptionReference reference = MakeOptionReference(commands);
  PrintCommandSections(commands, reference, out);
  out << ".SH SHARED OPTIONS\n";
  for (const SharedOptions& shared : reference.shared) {
    out << ".SS Of " << Roff(Names(shared, commands.size())) << "\n";
    for (const OptionEntry& entry : shared.entries) out << RoffEntry(entry.option);
  }
  out << ".SH EXIT STATUS\n"
      << ".TP\n.B 0\ndone\n"
      << ".TP\n.B 1\nfailed: the last line on standard error says what, where, and what to do\n"
      << ".TP\n.B 2\nwrong usage\n"
      << ".TP\n.B 3\ndone, but some input was left out: each is named on standard error and in the "
         "run's report\n"
      << ".SH SEE ALSO\n.BR colmap (1)\n";
}

void PrintBashCompletion(const std::vector<Command>& commands, std::ostream& out) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name);
  out << "# Made by 'colmap_seapoint help --format bash' from the program's option tables.\n"
      << "_colmap_seapoint() {\n"
      << "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
      << "  local command=${COMP_WORDS[1]} options= values=\n"
      << "  COMPREPLY=()\n"
      << "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      << "    COMPREPLY=($(compgen -W '" << WordsText(names) << " help version' -- \"$word\"))\n"
      << "    return\n"
      << "  fi\n"
      << "  case $command:$before in\n"
      << "    help:--format)\n      values='text man bash markdown' ;;\n";
  PrintValueCases(commands, out);
  out << "  esac\n"
      << "  if [ -n \"$values\" ]; then\n"
      << "    COMPREPLY=($(compgen -W \"$values\" -- \"$word\"))\n"
      << "    return\n"
      << "  fi\n"
      << "  # The value of another option: bash offers file names.\n"
      << "  case $before in --help) ;; --*) return ;; esac\n"
      << "  case $command in\n"
      << "    help)\n      options='--format' ;;\n";
  PrintOptionCases(commands, out);
  out << "  esac\n"
      << "  COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
      << "}\n"
      << "complete -o default -F _colmap_seapoint colmap_seapoint\n";
}

void PrintMarkdown(const std::vector<Command>& commands, std::ostream& out) {
  out << "# Options\n\nMade by `colmap_seapoint help --format markdown` from the program's option "
         "tables; `tests/options_reference_test.sh` fails when it is stale. Every command also "
         "takes `--project_path file.ini` and `-h`. Behind an option's text stand its legal range "
         "and where it comes from: a section of the paper, COLMAP, or this program (ours).\n";
  const OptionReference reference = MakeOptionReference(commands);
  for (size_t i = 0; i < commands.size(); ++i) {
    out << "\n## " << commands[i].name << "\n\n" << commands[i].summary << "\n\n";
    PrintOptionRows(reference.own[i], out);
    if (commands[i].foreign.group.empty()) continue;
    out << "| `--" << commands[i].foreign.group << ".*` | | " << Cell(commands[i].foreign.help)
        << " |\n";
  }
  for (const SharedOptions& shared : reference.shared) {
    out << "\n## Of " << Names(shared, commands.size()) << "\n\n";
    PrintOptionRows(shared.entries, out);
  }
}

}  // namespace colmap_seapoint
