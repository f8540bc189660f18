#include "colmap_seapoint/pictures/find_markers.h"

#include <cstdint>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/markers/detect_markers.h"
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
    // The search takes twice what decoding does.
    const MemoryShare share(3 * file.BytesToDecode());
    const GrayImage picture = file.DecodeGray();
    found.width = picture.width;
    found.height = picture.height;
    found.markers = DetectMarkers(picture, families);
  } catch (const Error& error) {
    found.reason = error.Finding();
  }
  return found;
}

}  // namespace

std::vector<MarkerSighting> FindMarkers(const std::filesystem::path& image_path,
                                        const std::vector<std::string>& names,
                                        const std::vector<MarkerFamily>& families, int num_threads,
                                        RunReport* report) {
  const int threads = EffectiveNumThreads(num_threads);
  const auto count = static_cast<int64_t>(names.size());
  std::vector<MarkerSighting> sightings;
  Progress progress("Pictures looked through for markers", count, 0, Work::kMarkers);
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

}  // namespace colmap_seapoint
