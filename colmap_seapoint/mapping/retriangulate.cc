#include "colmap_seapoint/mapping/retriangulate.h"

#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/subprocess.h"
#include "colmap_seapoint/mapping/colmap_log.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Pixels. COLMAP's own limits are 4.
constexpr char kMaxError[] = "1.5";
constexpr const char* kErrorLimits[] = {"Mapper.filter_max_reproj_error",
                                        "Mapper.tri_complete_max_reproj_error",
                                        "Mapper.tri_merge_max_reproj_error"};

// How COLMAP ends when no point is left to adjust; nothing else makes its adjustment fail there.
bool SaysNothingToAdjust(const std::string& line) {
  return line.find("Check failed: bundle_adjuster") != std::string::npos;
}

std::vector<std::string> Arguments(const ColmapProgram& colmap, const TriangulationJob& job,
                                   const fs::path& model, const fs::path& output) {
  std::vector<std::string> arguments = {"point_triangulator",
                                        "--database_path",
                                        job.database_path.string(),
                                        "--image_path",
                                        job.image_path.string(),
                                        "--input_path",
                                        model.string(),
                                        "--output_path",
                                        output.string(),
                                        "--clear_points",
                                        "1"};
  MapperOptions options = job.options;
  for (const char* limit : kErrorLimits) {
    if (colmap.HasMapperOption(limit)) options.emplace(limit, kMaxError);
  }
  AppendOptions(options, &arguments);
  return arguments;
}

// What speaks against taking `after` for `before`; "" when nothing does.
std::string Fault(const SparseModel& before, const SparseModel& after) {
  if (after.images.size() != before.images.size()) return "pictures were lost";
  if (2 * after.points3D.size() < before.points3D.size()) return "points were lost";
  return "";
}

// The model that COLMAP left; nullopt, with the reason, where it is none, or cut short: a disk that
// was full is not always reported.
std::optional<SparseModel> ReadOutput(const fs::path& output, const SubprocessResult& run,
                                      std::string* failure) {
  *failure = run.Text();
  if (!run.Succeeded()) return std::nullopt;
  *failure = "it left no model";
  if (!IsSparseModel(output)) return std::nullopt;
  try {
    return ReadSparseModel(output);
  } catch (const Error& error) {
    *failure = "it left a model that " + error.Finding();
    return std::nullopt;
  }
}

void ReportFailure(const ColmapProgram& colmap, const TriangulationJob& job, const fs::path& log,
                   const std::string& fault) {
  if (job.must_succeed) {
    throw Error(colmap.path.string(), fault,
                "see that the disk has room, read its output in " + log.string() +
                    " and run the same command again");
  }
  LogWarning(fault + "; its output is in " + log.string());
}

}  // namespace

Triangulation Retriangulate(const ColmapProgram& colmap, const TriangulationJob& job,
                            const fs::path& folder, const SparseModel& before) {
  const fs::path output = folder.string() + ".triangulated";
  std::error_code error;
  fs::remove_all(output, error);
  fs::create_directories(output);
  const fs::path log = job.log_path.string() + "_triangulation.log";
  Triangulation result;
  bool says_no_memory = false;
  const auto read_line = [&](const std::string& line) {
    says_no_memory = says_no_memory || SaysThatMemoryRanOut(line);
    if (SaysNothingToAdjust(line)) result.fault = "no point was found";
  };
  const auto run = RunSubprocess(colmap.path, Arguments(colmap, job, folder, output), log,
                                 read_line, colmap.timeout_seconds);
  std::string failure;
  result.model = ReadOutput(output, run, &failure);
  fs::remove_all(output, error);
  if (!result.model && !result.fault.empty()) return result;
  if (!result.model) {
    result.has_failed = true;
    result.fault = "the triangulation failed (" + failure + ")";
    ThrowIfFromOutside({run, says_no_memory, colmap.path, folder, log, result.fault});
    ReportFailure(colmap, job, log, result.fault);
    return result;
  }
  result.fault = Fault(before, *result.model);
  if (!result.fault.empty()) result.model.reset();
  return result;
}

}  // namespace colmap_seapoint
