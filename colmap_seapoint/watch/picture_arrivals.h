// Which pictures of a folder that is being filled are whole (ours). The folder is looked at again
// and again instead of asking the system to tell: that also works on the shares of a camera, a
// vehicle or a NAS, whose changes no system tells, and after a disk was pulled and put back.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

struct Arrival {
  std::string name;    // below the folder
  double seconds = 0;  // when it was seen first, whole or not, by the clock of Look()
};

using TakeArrival = std::function<void(const Arrival& arrival, const ColorImage& picture)>;

class PictureArrivals {
 public:
  explicit PictureArrivals(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Hands over the pictures that are whole since the last look, in the order of their names: their
  // size and time have not changed between two looks, and they can be decoded to the last row.
  // Others wait; one that was changed comes again. Reads what is new, once for each change. Throws
  // Error when the folder cannot be read, or has lost all of its pictures at once, as the mount
  // point of a disk that was pulled.
  void Look(double now, const TakeArrival& take);

  // Those that wait for the rest of their bytes.
  std::vector<std::string> Waiting() const;

 private:
  struct Picture {
    uintmax_t bytes = 0;
    std::filesystem::file_time_type written;
    double seconds = 0;
    bool is_steady = false;  // as it was at the look before
    bool was_tried = false;  // as it is now
    bool is_whole = false;
  };

  bool Stat(const std::string& name, Picture* picture) const;
  void LookAt(const std::string& name, double now, const TakeArrival& take);

  const std::filesystem::path folder_;
  std::map<std::string, Picture> pictures_;
};

}  // namespace colmap_seapoint
