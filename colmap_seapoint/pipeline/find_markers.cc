#include "colmap_seapoint/pipeline/find_markers.h"

#include <map>
#include <set>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/run_lock.h"
#include "colmap_seapoint/markers/detect_markers.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/pipeline/output_paths.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
namespace {

struct Found {
  int width = 0, height = 0;
  std::vector<DetectedMarker> markers;
  std::string reason;  // why the picture cannot be used; empty: it can
};

Found FindIn(const std::filesystem::path& path, const std::vector<MarkerFamily>& families) {
  Found found;
  try {
    const PictureFile file(path);
    const MemoryShare share(kMarkerBytesPerPixel * file.BytesToDecode());
    const GrayImage picture = file.DecodeGray();
    found.width = picture.width;
    found.height = picture.height;
    found.markers = DetectMarkers(picture, families);
  } catch (const Error& error) {
    found.reason = error.Finding();
  }
  return found;
}

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

std::vector<MarkerSighting> FindMarkers(const std::filesystem::path& image_path,
                                        const std::vector<std::string>& names,
                                        const std::vector<MarkerFamily>& families, int num_threads,
                                        RunReport* report) {
  const int threads = EffectiveNumThreads(num_threads);
  const auto count = static_cast<int64_t>(names.size());
  std::vector<MarkerSighting> sightings;
  Progress progress("Pictures looked through for markers", count);
  OrderedPipeline<Found>(
      threads, count, 2 * threads,
      [&](int64_t i) { return FindIn(image_path / names[static_cast<size_t>(i)], families); },
      [&](int64_t i, Found&& found) {
        const std::string& name = names[static_cast<size_t>(i)];
        if (!found.reason.empty()) LeaveOut(name, found.reason, report);
        for (const DetectedMarker& marker : found.markers) {
          sightings.push_back({MarkerText(marker.name), name, found.width, found.height,
                               marker.corners, marker.is_mirrored});
        }
        progress.Update(i + 1);
      });
  progress.Finish();
  return sightings;
}

std::vector<MarkerSighting> FindMarkersOnce(const MarkerSearch& search, const Workspace& workspace,
                                            WorkspaceState* state, RunReport* report) {
  constexpr char kStage[] = "markers";
  if (search.families.empty()) {
    state->Forget(kStage);
    state->Folder()->Remove(workspace.markers.filename().string());
    return {};
  }
  std::string inputs;
  for (const MarkerFamily family : search.families) inputs += FamilyText(family) + ",";
  std::vector<std::string> names;
  for (const RunReport::Input& picture : search.pictures) {
    inputs += "\n" + picture.name + " " + picture.hash;
    if (!picture.hash.empty()) names.push_back(picture.name);
  }
  const Stage stage = {kStage, kMarkerVersion, inputs, "The pictures' markers are known already"};
  const auto part = RunStage<RunReport>(state, stage, [&]() -> StageOutput<RunReport> {
    RunReport found;
    {
      StageTimer timer(&found, kStage);
      const auto sightings =
          FindMarkers(workspace.images, names, search.families, search.num_threads, &found);
      WriteTextFile(workspace.markers, MarkersCsv(sightings));
    }
    return {std::move(found), {workspace.markers}};
  });
  AddPart(part, report);
  return ReadMarkersCsv(workspace.markers);
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
