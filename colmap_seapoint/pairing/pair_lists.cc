#include "colmap_seapoint/pairing/pair_lists.h"

#include <algorithm>

#include "colmap_seapoint/base/natural_order.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kBlockSize = 50;  // pictures, as in COLMAP

ImagePair OrderedPair(const DatabaseImage& a, const DatabaseImage& b) {
  return std::minmax(a.image_id, b.image_id);
}

}  // namespace

void SortNaturally(std::vector<DatabaseImage>* images) {
  std::sort(images->begin(), images->end(),
            [](const auto& a, const auto& b) { return NaturalLess(a.name, b.name); });
}

std::vector<ImagePair> SequentialPairs(std::vector<DatabaseImage> images, int overlap) {
  SortNaturally(&images);
  std::vector<ImagePair> pairs;
  for (size_t i = 0; i < images.size(); ++i) {
    const size_t end = std::min(images.size(), i + 1 + static_cast<size_t>(overlap));
    for (size_t j = i + 1; j < end; ++j) pairs.push_back(OrderedPair(images[i], images[j]));
  }
  return pairs;
}

std::vector<ImagePair> ExhaustivePairs(std::vector<DatabaseImage> images) {
  SortNaturally(&images);
  std::vector<ImagePair> pairs;
  for (size_t block1 = 0; block1 < images.size(); block1 += kBlockSize) {
    for (size_t block2 = block1; block2 < images.size(); block2 += kBlockSize) {
      const size_t end1 = std::min(images.size(), block1 + kBlockSize);
      const size_t end2 = std::min(images.size(), block2 + kBlockSize);
      for (size_t i = block1; i < end1; ++i) {
        for (size_t j = std::max(block2, i + 1); j < end2; ++j) {
          pairs.push_back(OrderedPair(images[i], images[j]));
        }
      }
    }
  }
  return pairs;
}

}  // namespace colmap_seapoint
