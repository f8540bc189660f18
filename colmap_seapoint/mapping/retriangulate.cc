#include "colmap_seapoint/mapping/retriangulate.h"

#include <system_error>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/subprocess.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Pixels. COLMAP's own limits are 4.
constexpr char kMaxError[] = "1.5";
constexpr const char* kErrorLimits[] = {"Mapper.filter_max_reproj_error",
                                        "Mapper.tri_complete_max_reproj_error",
                                        "Mapper.tri_merge_max_reproj_error"};

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

}  // namespace

Triangulation Retriangulate(const ColmapProgram& colmap, const TriangulationJob& job,
                            const fs::path& folder, const SparseModel& before) {
  const fs::path output = folder.string() + ".triangulated";
  std::error_code error;
  fs::remove_all(output, error);
  fs::create_directories(output);
  const fs::path log = job.log_path.string() + "_triangulation.log";
  const auto run = RunSubprocess(colmap.path, Arguments(colmap, job, folder, output), log, {},
                                 colmap.timeout_seconds);
  Triangulation result;
  if (!run.Succeeded() || !IsSparseModel(output)) {
    result.fault = "the triangulation failed (" + run.Text() + ")";
  } else {
    result.model = ReadSparseModel(output);
    result.fault = Fault(before, *result.model);
    if (!result.fault.empty()) result.model.reset();
  }
  fs::remove_all(output, error);
  return result;
}

}  // namespace colmap_seapoint
