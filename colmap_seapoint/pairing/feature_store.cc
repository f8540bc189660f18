#include "colmap_seapoint/pairing/feature_store.h"

#include "colmap_seapoint/io/colmap/database_features.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMaxBytes = size_t{256} << 20;

size_t BytesOf(const Features& features) {
  return sizeof(Features) + features.points.size() * (sizeof(SeaPoint) + sizeof(Descriptor)) +
         features.sift_descriptors.size() * sizeof(SiftDescriptor);
}

}  // namespace

std::shared_ptr<const Features> FeatureStore::Read(uint32_t image_id) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (const auto known = entries_.find(image_id); known != entries_.end()) {
    recent_.splice(recent_.begin(), recent_, known->second);
    return known->second->features;
  }
  auto read = ReadFeatures(*database_, image_id);
  if (!read) return nullptr;
  auto features = std::make_shared<const Features>(std::move(*read));
  bytes_ += BytesOf(*features);
  recent_.push_front({image_id, features});
  entries_[image_id] = recent_.begin();
  while (bytes_ > kMaxBytes && recent_.size() > 1) {
    bytes_ -= BytesOf(*recent_.back().features);
    entries_.erase(recent_.back().image_id);
    recent_.pop_back();
  }
  return features;
}

}  // namespace colmap_seapoint
