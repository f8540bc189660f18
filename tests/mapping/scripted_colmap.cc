#include "tests/mapping/scripted_colmap.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "colmap_seapoint/io/colmap/colmap_model.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kScript[] = R"sh(#!/bin/sh
dir=$(dirname "$0")
command=$1
if [ "$command" = help ]; then cat "$dir/help"; exit 0; fi
if [ "$2" = -h ]; then exec cat "$dir/$command.help"; fi
call=1
while [ -e "$dir/$command.$call.arguments" ]; do call=$((call + 1)); done
for argument in "$@"; do echo "$argument"; done > "$dir/$command.$call.arguments"
while [ $# -gt 1 ]; do
  case $1 in
    --input_path) input=$2 ;;
    --output_path) output=$2 ;;
    --image_list_path | --*Mapper.image_list_path) cp "$2" "$dir/$command.$call.list" ;;
  esac
  shift
done
if [ -d "$dir/$command.$call.output" ]; then
  cp -r "$dir/$command.$call.output/." "$output"
elif [ "$command" = point_triangulator ] && [ ! -e "$dir/$command.$call.exit" ]; then
  cp -r "$input/." "$output"
fi
if [ -e "$dir/$command.$call.text" ]; then cat "$dir/$command.$call.text"; fi
if [ -e "$dir/$command.$call.killed" ]; then kill -KILL $$; fi
if [ -e "$dir/$command.$call.exit" ]; then exit "$(cat "$dir/$command.$call.exit")"; fi
exit 0
)sh";

std::string ReadAll(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

void WriteAll(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace

std::string MapperHelp(const std::string& version, const std::vector<std::string>& names) {
  std::string text = version +
                     "\n\nOptions can either be specified via command-line or by ...\n\n" +
                     "  -h [ --help ] \n  --database_path arg\n  --image_path arg\n" +
                     "  --image_list_path arg\n  --output_path arg\n";
  for (const std::string& name : names) text += "  --" + name + " arg (=1)\n";
  return text;
}

ScriptedColmap::ScriptedColmap(const fs::path& folder) : folder_(folder), path_(folder / "colmap") {
  fs::create_directories(folder);
  WriteAll(path_, kScript);
  fs::permissions(path_, fs::perms::owner_all);
  SetHelp(MapperHelp("COLMAP 3.8 (scripted)",
                     {"random_seed", "Mapper.num_threads", "Mapper.min_model_size",
                      "Mapper.ba_refine_extra_params", "Mapper.filter_max_reproj_error"}));
}

ColmapProgram ScriptedColmap::Program() const { return FindColmap(path_.string()); }

void ScriptedColmap::SetHelp(const std::string& mapper_help, const std::string& help,
                             const std::string& global_mapper_help) {
  WriteAll(folder_ / "mapper.help", mapper_help);
  WriteAll(folder_ / "help", help);
  WriteAll(folder_ / "global_mapper.help", global_mapper_help);
}

fs::path ScriptedColmap::FileOf(const std::string& command, int call,
                                const std::string& what) const {
  return folder_ / (command + "." + std::to_string(call) + "." + what);
}

void ScriptedColmap::Leaves(const std::string& command, int call, const std::string& name,
                            const SparseModel& model) {
  WriteSparseModelBinary(FileOf(command, call, "output") / name, model);
}

void ScriptedColmap::Ends(const std::string& command, int call, const std::string& text,
                          int exit_code) {
  WriteAll(FileOf(command, call, "text"), text + "\n");
  WriteAll(FileOf(command, call, "exit"), std::to_string(exit_code));
}

void ScriptedColmap::IsKilled(const std::string& command, int call) {
  WriteAll(FileOf(command, call, "killed"), "");
}

int ScriptedColmap::NumCalls(const std::string& command) const {
  int count = 0;
  while (fs::exists(FileOf(command, count + 1, "arguments"))) ++count;
  return count;
}

std::vector<std::string> ScriptedColmap::Arguments(const std::string& command, int call) const {
  std::ifstream file(FileOf(command, call, "arguments"));
  std::vector<std::string> arguments;
  for (std::string line; std::getline(file, line);) arguments.push_back(line);
  return arguments;
}

std::string ScriptedColmap::Value(const std::string& command, int call,
                                  const std::string& name) const {
  const std::vector<std::string> arguments = Arguments(command, call);
  const auto option = std::find(arguments.begin(), arguments.end(), "--" + name);
  return arguments.end() - option < 2 ? "" : *(option + 1);
}

std::string ScriptedColmap::ImageList(const std::string& command, int call) const {
  return ReadAll(FileOf(command, call, "list"));
}

}  // namespace colmap_seapoint
