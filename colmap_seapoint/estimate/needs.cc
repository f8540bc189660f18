#include "colmap_seapoint/estimate/needs.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Bytes.
constexpr double kDatabaseOfPicture = 0.5e6;  // its copies for the mapper come and go beside it
constexpr double kDatabases = 2.5;
constexpr double kModelsOfPicture = 0.4e6;
constexpr double kCloudPoint = 43;
constexpr double kMapPixel = 20;  // depth, normal, undistorted picture
// Of a picture, while the map is made: 2 of them stay. A part of its pixels is in the map.
constexpr double kOrthomosaicPixel = 6;
constexpr double kMemoryOfProgram = 180e6;
constexpr double kMemoryOfPicture = 1.8e6;  // of the model, while it is adjusted
constexpr double kMostPicturesInMemory = 1000;
constexpr double kMemoryOfMegapixel = 30e6;  // of pictures that are worked on

constexpr double kSamplesOfPicture = 0.75e6;
constexpr double kNewSamples = 0.5;  // of a picture's, that are not known from others
constexpr double kLeastShare = 0.3;  // that a job took of what is expected

double PixelsOfPicture(const JobSize& size) {
  return 1e6 * size.megapixels / std::max(static_cast<double>(size.num_pictures), 1.0);
}

}  // namespace

DiskNeeds ExpectedDiskNeeds(const JobSize& size) {
  const auto n = static_cast<double>(size.num_pictures);
  const double pixels = PixelsOfPicture(size);
  const double samples =
      size.step > 0 ? pixels / (size.step * size.step) : std::min(pixels, kSamplesOfPicture);
  const double cloud =
      kNewSamples * samples * kCloudPoint + (size.writes_maps ? kMapPixel * pixels : 0);
  DiskNeeds needs;
  needs.database_bytes = static_cast<uint64_t>(n * kDatabaseOfPicture);
  needs.model_bytes =
      static_cast<uint64_t>(n * ((kDatabases - 1) * kDatabaseOfPicture + kModelsOfPicture));
  needs.cloud_bytes = static_cast<uint64_t>(n * cloud);
  needs.map_bytes = static_cast<uint64_t>(size.makes_map ? n * kOrthomosaicPixel * pixels : 0);
  return needs;
}

Needs ExpectedNeeds(const JobSize& size) {
  const DiskNeeds disk = ExpectedDiskNeeds(size);
  const auto n = static_cast<double>(size.num_pictures);
  Needs needs;
  needs.disk_bytes = disk.database_bytes + disk.model_bytes + disk.cloud_bytes + disk.map_bytes;
  needs.memory_bytes = static_cast<uint64_t>(kMemoryOfProgram +
                                             kMemoryOfPicture * std::min(n, kMostPicturesInMemory) +
                                             kMemoryOfMegapixel * 1e-6 * PixelsOfPicture(size));
  return needs;
}

uint64_t FolderBytes(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_regular_file(status)) {
    const uint64_t bytes = fs::file_size(path, error);
    return error ? 0 : bytes;
  }
  uint64_t bytes = 0;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    const bool is_link = entry->is_symlink(error);
    if (!is_link) bytes += FolderBytes(entry->path());
    error.clear();
  }
  return bytes;
}

std::string NeedsText(const JobSize& size, const Needs& needs, const Supply& supply) {
  std::string text = std::to_string(size.num_pictures) +
                     (size.num_pictures == 1 ? " picture, " : " pictures, ") +
                     std::to_string(std::llround(std::ceil(size.megapixels))) +
                     " megapixels; disk: up to " + BytesText(needs.disk_bytes);
  if (supply.disk_bytes) text += " of " + BytesText(*supply.disk_bytes) + " free";
  text += "; memory: about " + BytesText(needs.memory_bytes);
  if (supply.memory_bytes > 0) text += " of " + BytesText(supply.memory_bytes);
  return text;
}

std::string TimesText(const OfWork<WorkCost>& costs, const OfWork<bool>& done_before,
                      double seconds_left) {
  std::string stages;
  const auto add = [&](const std::string& name, std::initializer_list<Work> works) {
    double seconds = 0;
    for (const Work work : works) {
      if (!done_before[work]) {
        seconds += static_cast<double>(costs[work].count) * costs[work].seconds_each;
      }
    }
    if (seconds > 0) stages += (stages.empty() ? "" : ", ") + name + " " + DurationText(seconds);
  };
  add("decoding", {Work::kIntake});
  add("SeaPoints", {Work::kPictures});
  add("matching", {Work::kLookAlikes, Work::kPairs});
  add("markers", {Work::kMarkers});
  add("mapping", {Work::kRegistration, Work::kRefinement});
  add("cloud", {Work::kDensification, Work::kMaps});
  add("map", {Work::kOrthomosaic});
  add("completeness", {Work::kCompleteness});
  return "About " + DurationText(seconds_left) + " on this machine" +
         (stages.empty() ? "" : ": " + stages);
}

DiskVerdict JudgeDisk(const Needs& needs, const Supply& supply) {
  if (!supply.disk_bytes) return DiskVerdict::kEnough;
  const auto there = static_cast<double>(*supply.disk_bytes + supply.workspace_bytes);
  const auto needed = static_cast<double>(needs.disk_bytes);
  if (there < kLeastShare * needed) return DiskVerdict::kTooSmall;
  return there < needed ? DiskVerdict::kMayBeFilled : DiskVerdict::kEnough;
}

}  // namespace colmap_seapoint
