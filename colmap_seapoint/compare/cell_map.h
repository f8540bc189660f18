// Values of the occupied cells of a grid without bounds.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace colmap_seapoint {

using CellKey = std::array<int64_t, 3>;

// Open addressing over a vector of the cells: 4 to 8 bytes a cell beside the cells themselves,
// about 30 ns a look-up. Cells are kept in the order in which they came.
template <typename Value>
class CellMap {
 public:
  using Item = std::pair<CellKey, Value>;

  // The cell's value; a fresh one when it was not there.
  Value& operator[](const CellKey& key) {
    if (2 * items_.size() >= slots_.size()) Grow();
    uint32_t& slot = slots_[FindSlot(key)];
    if (slot == kEmpty) {
      slot = static_cast<uint32_t>(items_.size());
      items_.emplace_back(key, Value());
    }
    return items_[slot].second;
  }

  const std::vector<Item>& Items() const { return items_; }

 private:
  static constexpr uint32_t kEmpty = 0xffffffff;

  static size_t Hash(const CellKey& key) {
    uint64_t hash = 0;
    for (const int64_t index : key) {
      hash = (hash ^ static_cast<uint64_t>(index)) * 0x9e3779b97f4a7c15ull;
      hash ^= hash >> 29;
    }
    return static_cast<size_t>(hash);
  }

  // The slot that holds the key, or the empty one where it belongs.
  size_t FindSlot(const CellKey& key) const {
    const size_t mask = slots_.size() - 1;
    size_t at = Hash(key) & mask;
    while (slots_[at] != kEmpty && items_[slots_[at]].first != key) at = (at + 1) & mask;
    return at;
  }

  void Grow() {
    slots_.assign(slots_.empty() ? 16 : 2 * slots_.size(), kEmpty);
    for (size_t i = 0; i < items_.size(); ++i) {
      slots_[FindSlot(items_[i].first)] = static_cast<uint32_t>(i);
    }
  }

  std::vector<Item> items_;
  std::vector<uint32_t> slots_;
};

}  // namespace colmap_seapoint
