#include "colmap_seapoint/cli/option_reference.h"

#include <algorithm>

namespace colmap_seapoint {
namespace {

bool ReadsTheSame(const OptionInfo& a, const OptionInfo& b) {
  return a.name == b.name && a.help == b.help && a.default_value == b.default_value &&
         a.required == b.required && a.origin == b.origin && a.min == b.min && a.max == b.max &&
         a.choices == b.choices;
}

std::vector<OptionEntry> CollectOptions(const std::vector<Command>& commands) {
  std::vector<OptionEntry> entries;
  for (const Command& command : commands) {
    OptionTable table;
    command.bind(&table);
    for (const OptionInfo& option : table.Options()) {
      auto known = std::find_if(entries.begin(), entries.end(), [&](const OptionEntry& entry) {
        return ReadsTheSame(entry.option, option);
      });
      if (known == entries.end()) known = entries.insert(known, {option, {}});
      known->commands.push_back(command.name);
    }
  }
  return entries;
}

}  // namespace

OptionReference MakeOptionReference(const std::vector<Command>& commands) {
  OptionReference reference;
  reference.own.resize(commands.size());
  for (const OptionEntry& entry : CollectOptions(commands)) {
    if (!entry.IsInGroup() && entry.commands.size() < commands.size()) {
      for (size_t i = 0; i < commands.size(); ++i) {
        const auto& takers = entry.commands;
        if (std::count(takers.begin(), takers.end(), commands[i].name) > 0) {
          reference.own[i].push_back(entry);
        }
      }
      continue;
    }
    auto shared =
        std::find_if(reference.shared.begin(), reference.shared.end(),
                     [&](const SharedOptions& group) { return group.commands == entry.commands; });
    if (shared == reference.shared.end()) {
      shared = reference.shared.insert(shared, {entry.commands, {}});
    }
    shared->entries.push_back(entry);
  }
  return reference;
}

}  // namespace colmap_seapoint
