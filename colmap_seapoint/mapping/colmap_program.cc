#include "colmap_seapoint/mapping/colmap_program.h"

#include <algorithm>
#include <cstdio>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/subprocess.h"
#include "colmap_seapoint/mapping/colmap_log.h"

namespace colmap_seapoint {
namespace {

struct MapperDefault {
  const char* name;
  const char* value;
};

// COLMAP 4.x also writes all that it says to a file in /tmp, which nobody removes.
constexpr MapperDefault kLogTarget = {"log_target", "stderr"};

constexpr MapperDefault kEveryRound[] = {
    // With several threads the bundle adjustment adds in another order each time: two runs on the
    // same database give other models. A run that was interrupted must end as one that was not.
    {"Mapper.num_threads", "1"},
    // COLMAP asks for 30. Hazy water leaves fewer; 20 costs the clear sets nothing (same models).
    {"Mapper.abs_pose_min_num_inliers", "20"},
    // COLMAP drops all but the first model of less than 10 pictures, and begins again at another
    // pair: dozens of times where a set falls into parts. What chance brings about has few points,
    // and is told by them (run_mapper.cc).
    {"Mapper.min_model_size", "3"},
};

// The models only have to lead the adjustment of our own (adjust_lens.h) to the right valley: all
// three efforts end with the same lens and centres, to tenths of a millimetre on exact surveys.
constexpr MapperDefault kSurveyEffort[] = {
    {"Mapper.ba_global_images_ratio", "1.4"},      {"Mapper.ba_global_frames_ratio", "1.4"},
    {"Mapper.ba_global_points_ratio", "1.4"},      {"Mapper.ba_global_max_refinements", "2"},
    {"Mapper.ba_global_max_num_iterations", "20"}, {"Mapper.ba_local_max_refinements", "1"},
    {"Mapper.ba_local_max_num_iterations", "10"},
};
constexpr MapperDefault kFieldEffort[] = {
    {"Mapper.ba_global_images_ratio", "2"},        {"Mapper.ba_global_frames_ratio", "2"},
    {"Mapper.ba_global_points_ratio", "2"},        {"Mapper.ba_global_max_refinements", "1"},
    {"Mapper.ba_global_max_num_iterations", "10"}, {"Mapper.ba_local_max_refinements", "1"},
    {"Mapper.ba_local_max_num_iterations", "5"},   {"Mapper.ba_local_num_images", "4"},
};

// COLMAP's own thresholds give the best first model. The pictures that they leave over are few to a
// place and share little: a round of their own, with less asked, still joins many of them.
constexpr MapperDefault kLaterRounds[] = {
    {"Mapper.init_min_num_inliers", "50"},      {"Mapper.init_min_tri_angle", "4"},
    {"Mapper.abs_pose_min_num_inliers", "15"},  {"Mapper.abs_pose_min_inlier_ratio", "0.15"},
    {"Mapper.tri_ignore_two_view_tracks", "0"},
};

constexpr char kInstallRemedy[] =
    "install COLMAP 3.8 or later (Debian: apt install colmap), or give its path with --colmap_path";

// The name in a line as "  --Mapper.min_model_size arg (=10)"; "" for other lines.
std::string OptionNameInHelp(const std::string& line) {
  const size_t begin = line.find("--");
  if (begin == std::string::npos || line.find_first_not_of(' ') < begin) return "";
  const size_t end = line.find_first_of(" =\t", begin);
  return line.substr(begin + 2, end == std::string::npos ? end : end - begin - 2);
}

}  // namespace

bool ColmapProgram::HasMapperOption(const std::string& name) const {
  return std::binary_search(mapper_options.begin(), mapper_options.end(), name);
}

ColmapProgram FindColmap(const std::string& colmap, double timeout_seconds) {
  ColmapProgram program;
  program.timeout_seconds = timeout_seconds;
  program.path = FindProgram(colmap, kInstallRemedy);
  const auto read_line = [&](const std::string& line) {
    const std::string message = MessageOf(line);
    if (program.version.empty() && message.compare(0, 6, "COLMAP") == 0) program.version = message;
    const std::string name = OptionNameInHelp(line);
    if (!name.empty()) program.mapper_options.push_back(name);
  };
  const auto run = [&](const std::vector<std::string>& arguments, const auto& on_line) {
    return RunSubprocess(program.path, arguments, {}, on_line, timeout_seconds);
  };
  const auto result = run({"mapper", "-h"}, read_line);
  run({"help"}, [&](const std::string& line) {
    program.has_global_mapper |= line.find(kGlobalMapper) != std::string::npos;
  });
  if (program.has_global_mapper) run({kGlobalMapper, "-h"}, read_line);
  std::sort(program.mapper_options.begin(), program.mapper_options.end());
  if (result.Succeeded() && program.HasMapperOption("database_path")) return program;
  throw Error(program.path.string(),
              "does not answer 'mapper -h' as COLMAP does (" + result.Text() + ")", kInstallRemedy);
}

std::string CameraModelProblem(const ColmapProgram& colmap, const CameraModelInfo& model) {
  int major = 0, minor = 0;
  if (std::sscanf(colmap.version.c_str(), "COLMAP %d.%d", &major, &minor) != 2) return "";
  const std::pair<int, int> since = model.model >= CameraModel::kEucm             ? std::pair(4, 1)
                                    : model.model >= CameraModel::kSimpleDivision ? std::pair(4, 0)
                                    : model.model >= CameraModel::kRadTanThinPrismFisheye
                                        ? std::pair(3, 11)
                                        : std::pair(0, 0);
  if (std::pair(major, minor) >= since) return "";
  return "this COLMAP (" + std::to_string(major) + "." + std::to_string(minor) +
         ") does not know the camera model " + model.name + ", which came with " +
         std::to_string(since.first) + "." + std::to_string(since.second);
}

void AppendOptions(const MapperOptions& options, std::vector<std::string>* arguments) {
  for (const auto& [name, value] : options) {
    arguments->insert(arguments->end(), {"--" + name, value});
  }
}

MapperOptions OptionsOfRound(const ColmapProgram& colmap, Round round, const std::string& effort,
                             int random_seed, const MapperOptions& user_options) {
  MapperOptions options;
  const auto add = [&](const std::string& name, const std::string& value) {
    if (colmap.HasMapperOption(name)) options[name] = value;
  };
  add(kLogTarget.name, kLogTarget.value);
  add("random_seed", std::to_string(random_seed));
  add("Mapper.random_seed", std::to_string(random_seed));  // later versions; -1 = from the clock
  for (const MapperDefault& option : kEveryRound) add(option.name, option.value);
  if (round == Round::kLater) {
    for (const MapperDefault& option : kLaterRounds) add(option.name, option.value);
  }
  if (effort == "survey") {
    for (const MapperDefault& option : kSurveyEffort) add(option.name, option.value);
  } else if (effort == "field") {
    for (const MapperDefault& option : kFieldEffort) add(option.name, option.value);
  }
  for (const auto& [name, value] : user_options) {
    if (!colmap.HasMapperOption(name)) {
      throw UsageError("--" + name + " " + value + ": this mapper has no such option ('" +
                       colmap.path.string() + " mapper -h' lists them)");
    }
    options[name] = value;
  }
  return options;
}

std::optional<MapperOptions> OptionsOfGlobalMapper(const ColmapProgram& colmap, int random_seed) {
  if (!colmap.has_global_mapper) return std::nullopt;
  MapperOptions options;
  const auto add = [&](const std::string& name, const std::string& value) {
    if (colmap.HasMapperOption(name)) options[name] = value;
  };
  add(kLogTarget.name, kLogTarget.value);
  add("GlobalMapper.num_threads", "1");
  add("GlobalMapper.random_seed", std::to_string(random_seed));
  return options;
}

}  // namespace colmap_seapoint
