#include "colmap_seapoint/mapping/retriangulate.h"

#include <system_error>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/subprocess.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Pixels; 4 in COLMAP.
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

}  // namespace

std::string Retriangulate(const ColmapProgram& colmap, const TriangulationJob& job,
                          const fs::path& model) {
  const SparseModel before = ReadSparseModel(model);
  const fs::path output = model.string() + ".triangulated";
  std::error_code error;
  fs::remove_all(output, error);
  fs::create_directories(output);
  const fs::path log = job.log_path.string() + "_triangulation.log";
  const auto result = RunSubprocess(colmap.path, Arguments(colmap, job, model, output), log, {});
  std::string fault;
  if (!result.Succeeded() || !IsSparseModel(output)) {
    fault = "the triangulation failed (" + result.Text() + ")";
  } else {
    const SparseModel after = ReadSparseModel(output);
    if (after.images.size() != before.images.size()) {
      fault = "pictures were lost";
    } else if (2 * after.points3D.size() < before.points3D.size()) {
      fault = "points were lost";
    } else {
      WriteSparseModelBinary(model, after);
    }
  }
  fs::remove_all(output, error);
  return fault;
}

}  // namespace colmap_seapoint
