#include "colmap_seapoint/mapping/mapper_process.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/subprocess.h"
#include "colmap_seapoint/mapping/colmap_log.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// How many pictures the present model has, from a line as "Registering image #3 (4)" (COLMAP 3.8)
// or "Registering frame #3 (num_reg_frames=4)" (later versions); nullopt for other lines.
std::optional<int> NumRegistered(const std::string& line) {
  const size_t what = line.find("Registering ");
  if (what == std::string::npos) return std::nullopt;
  const size_t open = line.find('(', what);
  if (open == std::string::npos) return std::nullopt;
  const size_t digits = line.find_first_of("0123456789", open);
  if (digits == std::string::npos) return std::nullopt;
  return std::atoi(line.c_str() + digits);
}

// The option that limits the pictures: the mapper's own from 4.2 on.
std::string ListOption(const ColmapProgram& colmap, const std::string& command) {
  const std::string common = "image_list_path";
  const std::string own = (command == kGlobalMapper ? "GlobalMapper." : "Mapper.") + common;
  return colmap.HasMapperOption(own) ? own : common;
}

std::vector<std::string> Arguments(const ColmapProgram& colmap, const MapperCall& call) {
  std::vector<std::string> arguments = {call.command,
                                        "--database_path",
                                        call.database_path.string(),
                                        "--image_path",
                                        call.image_path.string(),
                                        "--output_path",
                                        call.output_path.string()};
  if (!call.input_path.empty()) {
    arguments.insert(arguments.end(), {"--input_path", call.input_path.string()});
  }
  if (!call.pictures.empty()) {
    // Not beside a model that is continued, whose folder it would become part of.
    const fs::path& folder = call.input_path.empty() ? call.output_path : call.input_path;
    const fs::path list = folder / "pictures.txt";
    std::string names;
    for (const std::string& name : call.pictures) names += name + "\n";
    WriteTextFile(list, names);
    arguments.insert(arguments.end(), {"--" + ListOption(colmap, call.command), list.string()});
  }
  AppendOptions(call.options, &arguments);
  return arguments;
}

}  // namespace

MapperEnd RunMapperProcess(const ColmapProgram& colmap, const MapperCall& call) {
  Progress progress("Pictures registered by colmap mapper", static_cast<int64_t>(call.num_pictures),
                    0, Work::kRegistration);
  std::string last_message;
  bool says_no_model = false, says_no_memory = false;
  const auto read_line = [&](const std::string& line) {
    const std::string message = MessageOf(line);
    if (!message.empty()) last_message = message;
    says_no_model = says_no_model || SaysThatThereIsNoModel(message);
    says_no_memory = says_no_memory || SaysThatMemoryRanOut(message);
    if (const auto count = NumRegistered(message)) progress.Update(*count);
  };
  const SubprocessResult result = RunSubprocess(colmap.path, Arguments(colmap, call), call.log_path,
                                                read_line, colmap.timeout_seconds);
  if (SaysThatAnOptionIsRefused(last_message)) {
    throw UsageError("--Mapper: " + colmap.path.string() + " refuses a value: " + last_message);
  }
  MapperEnd end;
  end.text = result.Text() + ", '" + last_message + "'";
  const std::string finding = "the mapper failed (" + end.text + ")";
  if (!result.Succeeded() && !says_no_model) {
    ThrowIfFromOutside(
        {result, says_no_memory, colmap.path, call.output_path, call.log_path, finding});
  }
  const bool found_none =
      ListModels(call.output_path).empty() && (says_no_model || !call.must_succeed);
  end.is_usable = result.signal_number == 0 && (result.exit_code == 0 || found_none);
  if (end.is_usable) return end;
  if (call.must_succeed) {
    throw Error(colmap.path.string(), finding,
                "read its output in " + call.log_path.string() + " and run the same command again");
  }
  LogWarning(finding + "; its output is in " + call.log_path.string());
  return end;
}

std::vector<fs::path> ListModels(const fs::path& sparse) {
  std::vector<fs::path> models;
  std::error_code error;
  for (fs::directory_iterator entry(sparse, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_directory() && IsSparseModel(entry->path())) models.push_back(entry->path());
  }
  std::sort(models.begin(), models.end(), [](const fs::path& a, const fs::path& b) {
    return NaturalLess(a.filename().string(), b.filename().string());
  });
  return models;
}

}  // namespace colmap_seapoint
