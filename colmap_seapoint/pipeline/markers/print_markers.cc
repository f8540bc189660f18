#include "colmap_seapoint/pipeline/markers/print_markers.h"

#include <cstdio>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/run_lock.h"
#include "colmap_seapoint/report/marker_sheet.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

MarkerSheetOptions SheetOf(const PrintMarkersOptions& options) {
  const auto family = ParseMarkerFamily(options.family);
  if (!family) {
    throw UsageError("family is '" + options.family +
                     "', must be tag36h11, DICT_4X4, DICT_5X5 or DICT_6X6");
  }
  const MarkerSheetOptions sheet = {{*family, options.first_id},
                                    options.num_markers,
                                    1000 * options.size,
                                    1000 * options.bar_length};
  const std::string problem = CheckMarkerSheet(sheet);
  if (!problem.empty()) throw UsageError(problem);
  return sheet;
}

std::string BarRows(const MarkerSheetOptions& sheet) {
  if (sheet.bar_length_mm <= 0) return "";
  std::string text = "name1,name2,length_m\n";
  for (int k = 0; k + 1 < sheet.count; k += 2) {
    char length[32];
    std::snprintf(length, sizeof(length), ",%.4f\n", sheet.bar_length_mm / 1000);
    text += MarkerText({sheet.first.family, sheet.first.id + k}) + "," +
            MarkerText({sheet.first.family, sheet.first.id + k + 1}) + length;
  }
  return text;
}

}  // namespace

void PrintMarkersOptions::Bind(OptionTable* table) {
  table->AddRequired("output_path", &output_path, "PDF to write, A4");
  table->Add("family", &family, "tag36h11 (found best), DICT_4X4, DICT_5X5 or DICT_6X6", "ours");
  table->Add("first_id", &first_id, "number of the first marker", "ours", 0, 999);
  table->Add("num_markers", &num_markers, "how many, with one number after the other", "ours", 1,
             1000);
  table->Add("size", &size, "side of the black squares, metres", "ours", 0.01, 0.2);
  table->Add("bar_length", &bar_length,
             "metres between the centres of each two markers, as strips over several sheets; 0 = "
             "single markers",
             "ours", 0, 10);
  run.Bind(table);
  table->MarkOutput("output_path");
}

CommandResult RunPrintMarkers(const PrintMarkersOptions& options) {
  CheckOutputPaths(options);
  const MarkerSheetOptions sheet = SheetOf(options);
  CheckWritableDir(FolderOf(options.output_path));
  const RunLock lock = LockFile(options.output_path, "--output_path");
  CheckReplaceable(options.output_path, kPdfCreator,
                   "choose another --output_path, or remove the file");
  WritePdf(options.output_path, MarkerSheet(sheet));
  return {true, BarRows(sheet)};
}

}  // namespace colmap_seapoint
