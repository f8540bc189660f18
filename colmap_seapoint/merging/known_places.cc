#include "colmap_seapoint/merging/known_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr int kBits = 21;
constexpr int kMiddle = 1 << (kBits - 1);
constexpr int kRegionBits = 4;

Eigen::Vector3i CellOf(const Eigen::Vector3d& place, double spacing) {
  const Eigen::Vector3d cell = (place / spacing).array().floor();
  if (!(cell.array().abs().maxCoeff() < kMiddle - 2)) {
    throw Error(
        "--input_path", "holds a point that lies a million spacings from the origin",
        "see that the clouds are in one frame, near its origin; or give a larger --spacing");
  }
  return cell.cast<int>().array() + kMiddle;
}

uint64_t KeyOf(const Eigen::Vector3i& cell) {
  uint64_t key = 0;
  for (int k = 0; k < 3; ++k) key = key << kBits | static_cast<uint64_t>(cell[k]);
  return key;
}

Eigen::Vector3i CellOfKey(uint64_t key) {
  Eigen::Vector3i cell;
  for (int k = 2; k >= 0; --k, key >>= kBits) cell[k] = static_cast<int>(key & ((1 << kBits) - 1));
  return cell;
}

uint64_t RegionOf(const Eigen::Vector3i& cell) {
  return KeyOf(cell.unaryExpr([](int k) { return k >> kRegionBits; }));
}

void MergeInto(std::vector<uint64_t> added, std::vector<uint64_t>* keys) {
  std::sort(added.begin(), added.end());
  const auto middle = static_cast<std::ptrdiff_t>(keys->size());
  keys->insert(keys->end(), added.begin(), added.end());
  std::inplace_merge(keys->begin(), keys->begin() + middle, keys->end());
  keys->erase(std::unique(keys->begin(), keys->end()), keys->end());
}

}  // namespace

void KnownPlaces::Add(const Eigen::Vector3d& place) {
  const uint64_t key = KeyOf(CellOf(place, spacing_));
  if (added_.empty() || added_.back() != key) added_.push_back(key);
}

void KnownPlaces::Settle() {
  std::vector<uint64_t> regions;
  for (const uint64_t key : added_) {
    const uint64_t region = RegionOf(CellOfKey(key));
    if (regions.empty() || regions.back() != region) regions.push_back(region);
  }
  MergeInto(std::move(regions), &regions_);
  MergeInto(std::exchange(added_, {}), &cells_);
}

bool KnownPlaces::Holds(const Eigen::Vector3i& cell) const {
  return std::binary_search(cells_.begin(), cells_.end(), KeyOf(cell));
}

bool KnownPlaces::IsNear(const Eigen::Vector3d& place) const {
  const Eigen::Vector3i cell = CellOf(place, spacing_);
  // Most places are far from all that is known.
  bool is_far = true;
  for (int corner = 0; corner < 8 && is_far; ++corner) {
    const Eigen::Vector3i step((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                               (corner & 4) != 0 ? 1 : -1);
    is_far = !std::binary_search(regions_.begin(), regions_.end(), RegionOf(cell + step));
  }
  if (is_far) return false;
  for (int neighbor = 0; neighbor < 27; ++neighbor) {
    const Eigen::Vector3i step(neighbor % 3 - 1, neighbor / 3 % 3 - 1, neighbor / 9 - 1);
    if (Holds(cell + step)) return true;
  }
  return false;
}

}  // namespace colmap_seapoint
