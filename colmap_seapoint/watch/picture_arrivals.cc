#include "colmap_seapoint/watch/picture_arrivals.h"

#include <iterator>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/image_folder.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Empty while it is not whole.
ColorImage DecodeIfWhole(const fs::path& path) {
  try {
    return ReadColorImage(path);
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

// False where it is gone, or nothing yet.
bool PictureArrivals::Stat(const std::string& name, Picture* picture) const {
  std::error_code error;
  const fs::path path = folder_ / name;
  const uintmax_t bytes = fs::file_size(path, error);
  if (error || bytes == 0) return false;
  const auto written = fs::last_write_time(path, error);
  if (error) return false;
  picture->is_steady = picture->bytes == bytes && picture->written == written;
  if (picture->is_steady) return true;
  picture->bytes = bytes;
  picture->written = written;
  picture->was_tried = picture->is_whole = false;
  return true;
}

void PictureArrivals::LookAt(const std::string& name, double now, const TakeArrival& take) {
  const bool is_new = pictures_.count(name) == 0;
  Picture& picture = pictures_[name];
  const bool was_whole = picture.is_whole;
  if (!Stat(name, &picture)) return;
  if (is_new || (was_whole && !picture.is_whole)) picture.seconds = now;
  if (picture.was_tried || !picture.is_steady) return;
  picture.was_tried = true;
  const ColorImage pixels = DecodeIfWhole(folder_ / name);
  picture.is_whole = !pixels.Empty();
  if (picture.is_whole) take({name, picture.seconds}, pixels);
}

void PictureArrivals::Look(double now, const TakeArrival& take) {
  const std::vector<std::string> names = ListFolder(folder_).pictures;
  if (names.empty() && !pictures_.empty()) {
    throw Error(folder_.string(),
                "holds none of its " + std::to_string(pictures_.size()) + " pictures any more",
                "put its disk back");
  }
  for (const std::string& name : names) LookAt(name, now, take);
  const std::set<std::string> there(names.begin(), names.end());
  for (auto picture = pictures_.begin(); picture != pictures_.end();) {
    picture = there.count(picture->first) > 0 ? std::next(picture) : pictures_.erase(picture);
  }
}

std::vector<std::string> PictureArrivals::Waiting() const {
  std::vector<std::string> names;
  for (const auto& [name, picture] : pictures_) {
    if (!picture.is_whole) names.push_back(name);
  }
  return names;
}

}  // namespace colmap_seapoint
