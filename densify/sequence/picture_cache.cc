#include "densify/sequence/picture_cache.h"

#include <algorithm>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

// The new picture, and those still being read, count as much as the largest that is there.
void PictureCache::MakeRoom() {
  size_t largest = 0;
  for (const Entry& entry : pictures_) largest = std::max<size_t>(largest, *entry.num_bytes);
  const auto bytes_of = [&](const Entry& entry) {
    const size_t bytes = *entry.num_bytes;
    return bytes > 0 ? bytes : largest;
  };
  size_t total = largest;
  for (const Entry& entry : pictures_) total += bytes_of(entry);
  while (pictures_.size() >= kMinPictures && total > kMaxBytes) {
    total -= std::min(total, bytes_of(pictures_.front()));
    pictures_.pop_front();
  }
}

PictureCache::PendingPicture PictureCache::Start(int image_idx) {
  for (auto entry = pictures_.begin(); entry != pictures_.end(); ++entry) {
    if (entry->image_idx != image_idx) continue;
    std::rotate(entry, entry + 1, pictures_.end());
    return pictures_.back().pending;
  }
  MakeRoom();
  auto num_bytes = std::make_shared<std::atomic<size_t>>(0);
  const auto read = [source = source_, image_idx, num_bytes] {
    auto picture = std::make_shared<const Picture>(source->ReadPicture(image_idx));
    *num_bytes = picture->NumBytes();
    return picture;
  };
  PendingPicture pending = std::async(read).share();
  pictures_.push_back({image_idx, num_bytes, pending});
  return pending;
}

std::shared_ptr<const Picture> PictureCache::Get(int image_idx) {
  try {
    return Start(image_idx).get();
  } catch (const Error& error) {
    LeaveOut(image_idx, error.Finding());
    return nullptr;
  }
}

Features PictureCache::ObtainSeaPoints(int image_idx) {
  try {
    if (auto stored = source_->ReadSeaPoints(image_idx)) return std::move(*stored);
  } catch (const Error& error) {
    LeaveOut(image_idx, error.Finding());
    return {};
  }
  const auto picture = Get(image_idx);
  return picture ? source_->FindSeaPoints(*picture) : Features();
}

std::shared_ptr<const Features> PictureCache::GetSeaPoints(int image_idx) {
  for (const auto& [idx, features] : features_) {
    if (idx == image_idx) return features;
  }
  auto features = std::make_shared<const Features>(ObtainSeaPoints(image_idx));
  if (features_.size() >= kMaxFeatures) features_.pop_front();
  features_.emplace_back(image_idx, features);
  return features;
}

std::shared_ptr<const FeatureMatches> PictureCache::GetMatches(int image_idx1, int image_idx2) {
  const std::pair<int, int> pair(image_idx1, image_idx2);
  for (const auto& [known, matches] : matches_) {
    if (known == pair) return matches;
  }
  auto stored = source_->ReadMatches(image_idx1, image_idx2);
  auto matches = std::make_shared<const FeatureMatches>(
      stored ? std::move(*stored)
             : source_->Match(*GetSeaPoints(image_idx1), *GetSeaPoints(image_idx2)));
  if (matches_.size() >= kMaxMatches) matches_.pop_front();
  matches_.emplace_back(pair, matches);
  return matches;
}

void PictureCache::LeaveOut(int image_idx, const std::string& reason) {
  const bool known =
      std::any_of(left_out_.begin(), left_out_.end(),
                  [&](const LeftOutPicture& picture) { return picture.image_idx == image_idx; });
  if (!known) left_out_.push_back({image_idx, reason});
}

}  // namespace colmap_seapoint
