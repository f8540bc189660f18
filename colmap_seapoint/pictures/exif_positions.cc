#include "colmap_seapoint/pictures/exif_positions.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "colmap_seapoint/base/geodesy.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {
namespace {

constexpr double kNowhereDeg = 1e-6;    // from (0, 0)
constexpr double kSamePlaceM = 0.05;    // positions that differ by less are one
constexpr double kMinWithHeight = 0.5;  // share of the pictures; of fewer it is not used
constexpr double kMaxUtmLatitude = 84;

struct HeightKind {
  std::optional<double> CaptureHeights::*member;
  double sign;
  const char* text;
};

constexpr HeightKind kHeightKinds[] = {
    {&CaptureHeights::depth, -1, "heights from the depth in EXIF or XMP"},
    {&CaptureHeights::altitude, 1, "heights from the GPS altitude"},
    {&CaptureHeights::above_start, 1, "heights above where the flight began"},
};

bool IsNowhere(const GeoPosition& gps) {
  return std::abs(gps.latitude_deg) < kNowhereDeg && std::abs(gps.longitude_deg) < kNowhereDeg;
}

// nullptr: too few pictures tell one.
const HeightKind* ChooseHeights(const std::vector<const ReadablePicture*>& pictures) {
  const HeightKind* best = nullptr;
  auto best_count =
      static_cast<int64_t>(std::ceil(kMinWithHeight * static_cast<double>(pictures.size())));
  for (const HeightKind& kind : kHeightKinds) {
    const auto count =
        std::count_if(pictures.begin(), pictures.end(), [&](const ReadablePicture* picture) {
          return (picture->info.heights.*kind.member).has_value();
        });
    if (count > 0 && (best == nullptr ? count >= best_count : count > best_count)) {
      best = &kind;
      best_count = count;
    }
  }
  return best;
}

double ExtentM(const PicturePositions& positions) {
  const auto geo = [](const Eigen::Vector3d& p) { return GeoPosition{p.x(), p.y(), p.z()}; };
  const GeoPosition first = geo(positions.positions.begin()->second);
  double extent = 0;
  for (const auto& [name, position] : positions.positions) {
    extent = std::max(extent, LocalEastNorthUp(geo(position), first).norm());
  }
  return extent;
}

double MedianOf(const PicturePositions& positions, int axis) {
  std::vector<double> values;
  for (const auto& [name, position] : positions.positions) values.push_back(position[axis]);
  return UpperMedian(values);
}

}  // namespace

ExifPositions PositionsFromExif(const std::vector<ReadablePicture>& pictures) {
  ExifPositions result;
  std::vector<const ReadablePicture*> placed;
  size_t num_nowhere = 0;
  for (const ReadablePicture& picture : pictures) {
    if (!picture.info.gps) continue;
    num_nowhere += IsNowhere(*picture.info.gps);
    if (!IsNowhere(*picture.info.gps)) placed.push_back(&picture);
  }
  if (num_nowhere > 0) {
    LogWarning("the GPS position of " + std::to_string(num_nowhere) +
               " pictures is latitude 0, longitude 0, which is what a receiver writes that knows "
               "none: it is not used");
  }
  if (placed.empty()) return result;
  result.positions.is_geographic = true;
  const HeightKind* kind = ChooseHeights(placed);
  result.heights = kind != nullptr ? kind->text : "no heights: taken as level";
  for (const ReadablePicture* picture : placed) {
    const std::optional<double> height =
        kind != nullptr ? picture->info.heights.*kind->member : std::optional<double>(0);
    if (!height) continue;
    result.positions.positions[picture->name] = {picture->info.gps->latitude_deg,
                                                 picture->info.gps->longitude_deg,
                                                 (kind != nullptr ? kind->sign : 1) * *height};
  }
  if (result.positions.positions.size() > 1 && ExtentM(result.positions) < kSamePlaceM) {
    result.problem =
        "all pictures have the same GPS position, as of a camera that had its last "
        "fix above water";
    result.positions = {};
  }
  return result;
}

std::string SuggestedCrs(const PicturePositions& positions) {
  if (positions.positions.empty()) return "";
  const double latitude = MedianOf(positions, 0);
  const double longitude = std::remainder(MedianOf(positions, 1), 360.0);
  if (std::abs(latitude) > kMaxUtmLatitude) return "";
  const int zone = std::clamp(static_cast<int>(std::floor((longitude + 180) / 6)) + 1, 1, 60);
  return "EPSG:" + std::to_string((latitude >= 0 ? 32600 : 32700) + zone);
}

std::vector<PictureTime> TimesFromExif(const std::vector<ReadablePicture>& pictures) {
  std::vector<PictureTime> times;
  bool has_fraction = false;
  for (const ReadablePicture& picture : pictures) {
    const auto time = ParseClockTime(picture.info.taken);
    if (!time || !time->is_absolute) continue;
    has_fraction = has_fraction || time->seconds != std::floor(time->seconds);
    times.push_back({picture.name, *time});
  }
  if (!has_fraction) {
    for (PictureTime& time : times) time.time.seconds += 0.5;
  }
  return times;
}

PictureRecords RecordsFromExif(const std::vector<ReadablePicture>& pictures) {
  return {PositionsFromExif(pictures), TimesFromExif(pictures)};
}

}  // namespace colmap_seapoint
