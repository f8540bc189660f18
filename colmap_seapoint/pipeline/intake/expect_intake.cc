#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/image_folder.h"
#include "colmap_seapoint/io/video/video_file.h"
#include "colmap_seapoint/pipeline/intake/take_in.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Of phones and cameras: their headers are not asked, since the plan is made anew once all is read.
constexpr double kMegapixelsOfPicture = 12;
constexpr double kFramesTakenPerSecond = 1;

void AddClip(const fs::path& path, IntakeSize* size) {
  try {
    const VideoFile video(path, 1);
    const VideoInfo& info = video.Info();
    const double megapixels = 1e-6 * info.width * info.height;
    const double num_taken = std::ceil(kFramesTakenPerSecond * info.duration_seconds);
    size->video_seconds += std::llround(info.duration_seconds);
    size->decoded_megapixels += megapixels * info.duration_seconds / info.frame_seconds;
    size->num_pictures += static_cast<int64_t>(num_taken);
    size->megapixels += megapixels * num_taken;
  } catch (const Error&) {
    // Which is said when it is taken in.
  }
}

}  // namespace

IntakeSize ExpectIntake(const fs::path& given) {
  IntakeSize size;
  if (!fs::is_directory(given)) {
    AddClip(given, &size);
    return size;
  }
  const FolderListing listing = ListFolder(given);
  size.num_copies = static_cast<int64_t>(listing.camera_pictures.size());
  size.decoded_megapixels = kMegapixelsOfPicture * static_cast<double>(size.num_copies);
  size.num_pictures = size.num_copies + static_cast<int64_t>(listing.pictures.size());
  size.megapixels = kMegapixelsOfPicture * static_cast<double>(size.num_pictures);
  if (size.num_pictures > 0) return size;
  for (const std::string& name : listing.videos) AddClip(given / name, &size);
  return size;
}

}  // namespace colmap_seapoint
