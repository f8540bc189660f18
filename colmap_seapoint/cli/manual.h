// The man page and the bash completion, made from the same option tables as `-h`: neither is
// written by hand, so neither can say what the program does not do.
#pragma once

#include <ostream>
#include <vector>

#include "colmap_seapoint/cli/command.h"

namespace colmap_seapoint {

// Section 1, in roff with the man macros: every command with its own options, then what
// several take (option groups), once, with the commands that take it.
void PrintManPage(const std::vector<Command>& commands, std::ostream& out);

// A script to be sourced by bash: commands, their options, choices, and file names.
void PrintBashCompletion(const std::vector<Command>& commands, std::ostream& out);

// colmap_seapoint/OPTIONS.md: a table a command, then what several commands take.
void PrintMarkdown(const std::vector<Command>& commands, std::ostream& out);

}  // namespace colmap_seapoint
