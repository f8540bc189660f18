#include "colmap_seapoint/pipeline/markers/marker_finder.h"

#include <map>
#include <set>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/run_lock.h"
#include "colmap_seapoint/pictures/find_markers.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

// A line a marker: in how many pictures it is. Those in a single one give no place.
std::string CountText(const std::vector<MarkerSighting>& sightings) {
  std::map<std::string, std::set<std::string>> pictures;
  for (const MarkerSighting& sighting : sightings) {
    pictures[sighting.marker + (sighting.is_mirrored ? " (mirror image)" : "")].insert(
        sighting.image);
  }
  std::string text;
  size_t num_once = 0;
  for (const auto& [marker, names] : pictures) {
    if (names.size() < 2) {
      ++num_once;
    } else {
      text += marker + ": in " + std::to_string(names.size()) + " pictures\n";
    }
  }
  if (num_once > 0) text += std::to_string(num_once) + " more, each in one picture only\n";
  return text.empty() ? "no marker is found\n" : text;
}

}  // namespace

void MarkerFinderOptions::Bind(OptionTable* table) {
  table->AddRequired("image_path", &image_path, "folder of the pictures, sub-folders included");
  table->AddRequired("output_path", &output_path,
                     "CSV to write: a row a marker and picture, with its four corners");
  table->Add("image_list_path", &image_list_path,
             "names of the pictures to take, one a line; empty = all", "COLMAP");
  table->Add("families", &families,
             "which markers: tag36h11, DICT_4X4, DICT_5X5, DICT_6X6, with commas between them",
             "ours");
  run.Bind(table);
  table->MarkOutput("output_path");
}

CommandResult RunMarkerFinder(const MarkerFinderOptions& options) {
  CheckOutputPaths(options);
  const auto families = ParseMarkerFamilies(options.families);
  if (!families) {
    throw UsageError("families is '" + options.families +
                     "', must be of tag36h11, DICT_4X4, DICT_5X5 and DICT_6X6, with commas between "
                     "them");
  }
  CheckWritableDir(FolderOf(options.output_path));
  const RunLock lock = LockFile(options.output_path, "--output_path");
  CheckReplaceable(options.output_path, kMarkersHeader,
                   "choose another --output_path, or remove the file");
  RunReport report = StartReport("marker_finder", options, options.run);
  const std::vector<std::string> names =
      ListPictures(options.image_path, options.image_list_path, &report);
  const auto sightings =
      FindMarkers(options.image_path, names, *families, options.run.num_threads, &report);
  WriteTextFile(options.output_path, MarkersCsv(sightings));
  return {report.left_out.empty(), CountText(sightings)};
}

}  // namespace colmap_seapoint
