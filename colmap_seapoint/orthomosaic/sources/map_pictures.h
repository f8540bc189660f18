// Pictures of a survey, decoded as seldom as the memory allows.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "colmap_seapoint/base/picture.h"

namespace colmap_seapoint {

// Reads picture `i` of the model, with its mask; an empty one when it cannot be used (the reader
// says why). From several threads, each picture in one of them at a time.
using MapPictureReader = std::function<Picture(size_t picture)>;

class MapPictures {
 public:
  // `read` must outlive it. Beside pictures in use, at most `max_bytes` of them are kept.
  // `reduction`, by picture: how often both sides are halved (each pixel the mean of four) where
  // the map is coarser than the picture.
  MapPictures(const MapPictureReader& read, std::vector<int> reduction, size_t max_bytes);

  // Waits where another thread is reading it. Never null; may be empty.
  std::shared_ptr<const Picture> Get(uint32_t picture);
  int Reduction(uint32_t picture) const { return reduction_[picture]; }
  size_t NumReads() const { return num_reads_; }

 private:
  struct Entry {
    std::shared_ptr<const Picture> picture;  // null while it is read
    uint64_t last_use = 0;
  };
  void DropOldest();

  const MapPictureReader& read_;
  std::vector<int> reduction_;
  size_t max_bytes_, bytes_ = 0, num_reads_ = 0;
  std::mutex mutex_;
  std::condition_variable is_read_;
  std::map<uint32_t, Entry> entries_;
  uint64_t num_uses_ = 0;
};

// Half of both sides, rounded down (at least 1); a pixel is the mean of four. Masks hide what any
// of the four hides.
Picture HalvedPicture(const Picture& picture);

}  // namespace colmap_seapoint
