#include "colmap_seapoint/navigation/measured_positions.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "colmap_seapoint/io/navigation/nav_log.h"
#include "colmap_seapoint/navigation/log_positions.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinPositions = 3;
constexpr double kMaxScaleSigma = 0.1;  // of the scale
constexpr double kMinAgreeing = 0.5;    // share of the positions

std::vector<TimedPicture> TimedPictures(const SparseModel& model,
                                        const std::vector<PictureTime>& times) {
  std::map<std::string, ClockTime> by_name;
  for (const PictureTime& time : times) by_name.emplace(time.image, time.time);
  std::vector<TimedPicture> pictures;
  for (const PosedImage& image : model.images) {
    const auto time = by_name.find(image.name);
    if (time == by_name.end()) continue;
    pictures.push_back({image.name, time->second, image.cam_from_world.OriginInSource()});
  }
  return pictures;
}

PositionSource FromLog(const ScaleSources& sources, const PictureRecords& records,
                       const SparseModel& model) {
  PositionSource source;
  source.is_there = true;
  const NavLog log = ReadNavLogs(sources.nav, "--nav");
  const std::vector<PictureTime> times = sources.nav_times.empty()
                                             ? records.times
                                             : ReadPictureTimes(sources.nav_times, "--nav_times");
  LogPositions found =
      PlaceByLog(TimedPictures(model, times), log, {sources.NavOffset(), sources.max_nav_offset});
  source.problem = found.problem;
  source.measured = {std::move(found.positions), sources.nav, sources.crs};
  source.text = "from the log " + sources.nav + ": " + found.text +
                (log.has_height ? "" : "; it has no depth: the track is taken as level");
  return source;
}

PositionSource FromExif(const ScaleSources& sources, const PictureRecords& records,
                        const SparseModel& model) {
  PositionSource source;
  source.is_there = !records.gps.positions.positions.empty() || !records.gps.problem.empty();
  source.problem = records.gps.problem;
  if (!source.is_there || !source.problem.empty()) return source;
  const auto& positions = records.gps.positions.positions;
  const auto count =
      std::count_if(model.images.begin(), model.images.end(),
                    [&](const PosedImage& image) { return positions.count(image.name) > 0; });
  if (count < static_cast<int64_t>(kMinPositions)) {
    source.problem = "only " + std::to_string(count) + " pictures of the model have a position";
  }
  const std::string crs = sources.crs.empty() ? SuggestedCrs(records.gps.positions) : sources.crs;
  source.measured = {records.gps.positions, "the pictures' GPS", crs};
  source.text =
      "from the GPS in the pictures, " + records.gps.heights + " (--positions_path none declines)";
  return source;
}

}  // namespace

PositionSource FindPositions(const ScaleSources& sources, const PictureRecords& records,
                             const SparseModel& model) {
  if (!sources.nav.empty()) return FromLog(sources, records, model);
  if (sources.Any() || sources.DeclinesPositions()) return {};
  return FromExif(sources, records, model);
}

std::string Doubt(const SimilarityEstimate& estimate) {
  if (!estimate.problem.empty()) return estimate.problem;
  const auto& used = estimate.position_used;
  const auto num_used = static_cast<double>(std::count(used.begin(), used.end(), true));
  if (num_used < kMinAgreeing * static_cast<double>(used.size())) {
    return "most of the positions contradict the model and each other";
  }
  const double sigma = estimate.scale_sigma / estimate.metric_from_model.scale;
  if (sigma <= kMaxScaleSigma) return "";
  char text[160];
  std::snprintf(text, sizeof(text),
                "the positions scatter by %.1f m, too much for so small a place: the size would "
                "be uncertain by %.0f %%",
                estimate.position_rms, 100 * sigma);
  return text;
}

}  // namespace colmap_seapoint
