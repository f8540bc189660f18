#include "colmap_seapoint/orthomosaic/sources/map_pictures.h"

#include <algorithm>
#include <utility>

namespace colmap_seapoint {
namespace {

template <typename Combine>
GrayImage Halved(const GrayImage& image, const Combine& combine) {
  if (image.Empty()) return image;
  GrayImage half(std::max(1, image.width / 2), std::max(1, image.height / 2));
  const int dx = image.width > 1 ? 1 : 0, dy = image.height > 1 ? 1 : 0;
  for (int y = 0; y < half.height; ++y) {
    const uint8_t *above = image.Row(2 * y), *below = image.Row(2 * y + dy);
    uint8_t* row = half.Row(y);
    for (int x = 0; x < half.width; ++x) {
      row[x] = combine(above[2 * x], above[2 * x + dx], below[2 * x], below[2 * x + dx]);
    }
  }
  return half;
}

uint8_t Mean(int a, int b, int c, int d) { return static_cast<uint8_t>((a + b + c + d + 2) / 4); }
uint8_t Least(uint8_t a, uint8_t b, uint8_t c, uint8_t d) { return std::min({a, b, c, d}); }

}  // namespace

Picture HalvedPicture(const Picture& picture) {
  Picture half;
  half.luma = Halved(picture.luma, Mean);
  half.mask = Halved(picture.mask, Least);
  half.cb = Halved(picture.cb, Mean);
  half.cr = Halved(picture.cr, Mean);
  half.chroma_shift_x = picture.chroma_shift_x;
  half.chroma_shift_y = picture.chroma_shift_y;
  return half;
}

MapPictures::MapPictures(const MapPictureReader& read, std::vector<int> reduction, size_t max_bytes)
    : read_(read), reduction_(std::move(reduction)), max_bytes_(max_bytes) {}

std::shared_ptr<const Picture> MapPictures::Get(uint32_t picture) {
  {
    std::unique_lock<std::mutex> lock(mutex_);
    for (auto found = entries_.find(picture); found != entries_.end();
         found = entries_.find(picture)) {
      found->second.last_use = ++num_uses_;
      if (found->second.picture) return found->second.picture;
      is_read_.wait(lock);
    }
    entries_[picture].last_use = ++num_uses_;
    ++num_reads_;
  }
  auto decoded = std::make_shared<Picture>();
  try {
    *decoded = read_(picture);
    for (int i = 0; i < reduction_[picture]; ++i) *decoded = HalvedPicture(*decoded);
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    entries_.erase(picture);
    is_read_.notify_all();
    throw;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_[picture].picture = decoded;
  bytes_ += decoded->NumBytes();
  is_read_.notify_all();
  DropOldest();
  return decoded;
}

// Never the one that came last.
void MapPictures::DropOldest() {
  while (bytes_ > max_bytes_) {
    auto oldest = entries_.end();
    size_t num_kept = 0;
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      if (!it->second.picture) continue;
      ++num_kept;
      if (oldest == entries_.end() || it->second.last_use < oldest->second.last_use) oldest = it;
    }
    if (num_kept < 2) return;
    bytes_ -= oldest->second.picture->NumBytes();
    entries_.erase(oldest);
  }
}

}  // namespace colmap_seapoint
