#include "colmap_seapoint/pipeline/cloud_exporter.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/las/export_cloud.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/run_lock.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

LasPacking PackingOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".las") return LasPacking::kNone;
  if (extension == ".laz") return LasPacking::kLaz;
  throw UsageError("--output_path " + path + ": must end in .las or .laz");
}

std::optional<ModelUnits> UnitsOf(const CloudExporterOptions& options) {
  if (options.units_path.empty()) return ReadModelUnits(FolderOf(options.input_path));
  return ReadModelUnitsFile(options.units_path);
}

}  // namespace

void CloudExporterOptions::Bind(OptionTable* table) {
  table->AddRequired("input_path", &input_path, "cloud, PLY");
  table->AddRequired("output_path", &output_path,
                     "the same as LAS 1.4 (.las) or packed (.laz, where the build has LASzip)");
  table->Add("units_path", &units_path,
             "units.json of the cloud: its offset is added, its reference system written; empty = "
             "the one beside the cloud, if there is one",
             "ours");
  run.Bind(table);
  table->MarkOutput("output_path");
}

CommandResult RunCloudExporter(const CloudExporterOptions& options) {
  CheckOutputPaths(options);
  CloudExport how;
  how.packing = PackingOf(options.output_path);
  CheckWritableDir(FolderOf(options.output_path));
  const RunLock lock = LockFile(options.output_path, "--output_path");
  CheckReplaceable(options.output_path, kLasWords,
                   "choose another --output_path, or remove the file");
  const std::optional<ModelUnits> units = UnitsOf(options);
  if (units) {
    how.shift = units->offset;
    how.crs = ReferenceSystem(*units);
  }
  const uint64_t num_points = ExportCloud(options.input_path, options.output_path, how);
  LogInfo(std::to_string(num_points) + " points, " + UnitsText(units) + ": " + options.output_path);
  return {};
}

}  // namespace colmap_seapoint
