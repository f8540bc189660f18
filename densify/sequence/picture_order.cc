#include "densify/sequence/picture_order.h"

#include <algorithm>
#include <numeric>

#include "colmap_seapoint/base/natural_order.h"

namespace colmap_seapoint {

namespace {

constexpr double kMinContinuity = 0.5;  // of the walk's, for the names' order to stand

std::vector<int> OrderByName(const SparseModel& model) {
  std::vector<int> order(model.images.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return NaturalLess(model.images[static_cast<size_t>(a)].name,
                       model.images[static_cast<size_t>(b)].name);
  });
  return order;
}

std::vector<int> WalkOver(const Covisibility& covisibility, const std::vector<int>& by_name) {
  std::vector<int> rank(by_name.size());
  for (size_t k = 0; k < by_name.size(); ++k) {
    rank[static_cast<size_t>(by_name[k])] = static_cast<int>(k);
  }
  std::vector<uint8_t> visited(by_name.size(), 0);
  std::vector<int> walk;
  size_t lowest = 0;  // no name before it is left
  int next = -1;
  while (walk.size() < by_name.size()) {
    if (next < 0) {
      while (visited[static_cast<size_t>(by_name[lowest])] != 0) ++lowest;
      next = by_name[lowest];
    }
    const auto present = static_cast<size_t>(next);
    walk.push_back(next);
    visited[present] = 1;
    next = -1;
    double most = 0;
    for (const SharedPoints& other : covisibility[present]) {
      const auto idx = static_cast<size_t>(other.image_idx);
      if (visited[idx] != 0 || other.count < most) continue;
      if (other.count == most && (next < 0 || rank[idx] > rank[static_cast<size_t>(next)]))
        continue;
      most = other.count;
      next = other.image_idx;
    }
  }
  return walk;
}

}  // namespace

int64_t Continuity(const SparseModel& model, const std::vector<int>& order) {
  int64_t sum = 0;
  for (size_t k = 1; k < order.size(); ++k) {
    sum += NumSharedPoints(model.images[static_cast<size_t>(order[k - 1])],
                           model.images[static_cast<size_t>(order[k])]);
  }
  return sum;
}

std::vector<int> OrderPictures(const SparseModel& model, const Covisibility& covisibility) {
  const std::vector<int> by_name = OrderByName(model);
  const std::vector<int> walk = WalkOver(covisibility, by_name);
  const auto names = static_cast<double>(Continuity(model, by_name));
  const auto best = static_cast<double>(Continuity(model, walk));
  return names >= kMinContinuity * best ? by_name : walk;
}

}  // namespace colmap_seapoint
