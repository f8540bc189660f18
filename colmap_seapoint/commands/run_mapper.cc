#include "colmap_seapoint/commands/run_mapper.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap_model.h"
#include "colmap_seapoint/io/subprocess.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

struct MapperDefault {
  const char* name;
  const char* value;
};

// Only those that this COLMAP knows are given.
constexpr MapperDefault kMapperDefaults[] = {
    // With several threads the bundle adjustment adds in another order each time: two runs on the
    // same database give other models. A run that was interrupted must end as one that was not.
    {"Mapper.num_threads", "1"},
};

constexpr char kInstallRemedy[] =
    "install COLMAP 3.8 or later (Debian: apt install colmap), or give its path with --colmap_path";

// "  --Mapper.min_model_size arg (=10)" -> "Mapper.min_model_size"; empty for other lines.
std::string OptionNameInHelp(const std::string& line) {
  const size_t begin = line.find("--");
  if (begin == std::string::npos || line.find_first_not_of(' ') < begin) return "";
  const size_t end = line.find_first_of(" =\t", begin);
  return line.substr(begin + 2, end == std::string::npos ? end : end - begin - 2);
}

// "Registering image #3 (4)" (3.8), "Registering frame #3 (num_reg_frames=4)" (later): how many
// pictures the present model has.
std::optional<int> NumRegistered(const std::string& line) {
  const size_t what = line.find("Registering ");
  const size_t open = line.find('(', what == std::string::npos ? 0 : what);
  if (what == std::string::npos || open == std::string::npos) return std::nullopt;
  const size_t digits = line.find_first_of("0123456789", open);
  if (digits == std::string::npos || digits + 9 < line.find(')', digits)) return std::nullopt;
  return std::atoi(line.c_str() + digits);
}

void RemoveAll(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (!error) return;
  throw Error(path.string(), "cannot be removed (" + error.message() + ")",
              "remove it by hand, or choose another --workspace_path");
}

void Rename(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (!error) return;
  throw Error(from.string(), "cannot be renamed to " + to.string() + " (" + error.message() + ")",
              "check the folder's permissions");
}

std::vector<std::string> Arguments(const MapperJob& job, const fs::path& output_path) {
  std::vector<std::string> arguments = {"mapper",
                                        "--database_path",
                                        job.database_path.string(),
                                        "--image_path",
                                        job.image_path.string(),
                                        "--output_path",
                                        output_path.string()};
  for (const auto& [name, value] : job.options) {
    arguments.push_back("--" + name);
    arguments.push_back(value);
  }
  return arguments;
}

// Throws unless the mapper ended well and left a model.
void CheckMapperResult(const ColmapProgram& colmap, const MapperJob& job,
                       const SubprocessResult& result, const std::string& last_line,
                       bool found_model) {
  if (result.Succeeded() && found_model) return;
  const std::string end = result.Text() + ", '" + last_line + "'";
  const std::string log = job.log_path.string();
  if (last_line.find("parse options") != std::string::npos ||
      last_line.find("Invalid options") != std::string::npos) {
    throw UsageError("--Mapper: " + colmap.path.string() + " refuses a value: " + last_line);
  }
  // COLMAP 3.8 exits with 1 both without matches and without a model.
  if (found_model || result.signal_number != 0) {
    throw Error(colmap.path.string(), "the mapper failed (" + end + ")",
                "read its output in " + log + " and run the same command again");
  }
  throw Error(job.database_path.string(), "the mapper found no model (" + end + ")",
              "take pictures that overlap more, or relax --Mapper.init_min_num_inliers and "
              "--Mapper.init_min_tri_angle; its output is in " +
                  log);
}

}  // namespace

bool ColmapProgram::HasMapperOption(const std::string& name) const {
  return std::binary_search(mapper_options.begin(), mapper_options.end(), name);
}

ColmapProgram FindColmap(const std::string& colmap) {
  ColmapProgram program;
  program.path = FindProgram(colmap, kInstallRemedy);
  const auto result =
      RunSubprocess(program.path, {"mapper", "-h"}, {}, [&](const std::string& line) {
        if (program.version.empty() && line.compare(0, 6, "COLMAP") == 0) program.version = line;
        const std::string name = OptionNameInHelp(line);
        if (!name.empty()) program.mapper_options.push_back(name);
      });
  std::sort(program.mapper_options.begin(), program.mapper_options.end());
  if (!result.Succeeded() || !program.HasMapperOption("database_path")) {
    throw Error(program.path.string(),
                "does not answer 'mapper -h' as COLMAP does (" + result.Text() + ")",
                kInstallRemedy);
  }
  return program;
}

std::map<std::string, std::string> MapperOptions(
    const ColmapProgram& colmap, int random_seed,
    const std::map<std::string, std::string>& user_options) {
  std::map<std::string, std::string> options;
  const auto add = [&](const std::string& name, const std::string& value) {
    if (colmap.HasMapperOption(name)) options[name] = value;
  };
  add("random_seed", std::to_string(random_seed));
  add("Mapper.random_seed", std::to_string(random_seed));  // later versions; -1 = from the clock
  for (const MapperDefault& option : kMapperDefaults) add(option.name, option.value);
  for (const auto& [name, value] : user_options) {
    if (!colmap.HasMapperOption(name)) {
      throw UsageError("--" + name + " " + value + ": this mapper has no such option ('" +
                       colmap.path.string() + " mapper -h' lists them)");
    }
    options[name] = value;
  }
  return options;
}

void RunMapper(const ColmapProgram& colmap, const MapperJob& job) {
  const fs::path temporary = job.output_path.string() + ".tmp";
  RemoveAll(temporary);
  fs::create_directories(temporary);
  Progress progress("Pictures registered by colmap mapper", job.num_images);
  std::string last_line;
  const auto result = RunSubprocess(colmap.path, Arguments(job, temporary), job.log_path,
                                    [&](const std::string& line) {
                                      if (!line.empty()) last_line = line;
                                      if (const auto count = NumRegistered(line)) {
                                        progress.Update(*count);
                                      }
                                    });
  CheckMapperResult(colmap, job, result, last_line, !ListModels(temporary).empty());
  RemoveAll(job.output_path);
  Rename(temporary, job.output_path);
  progress.Finish();
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
