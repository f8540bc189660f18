#include "densify/densify_sequence.h"

#include <algorithm>
#include <numeric>

#include "colmap_seapoint/base/natural_order.h"
#include "densify/sequence/sequence_state.h"

namespace colmap_seapoint {

namespace {

std::vector<int> SequenceOrder(const SparseModel& model) {
  std::vector<int> order(model.images.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return NaturalLess(model.images[static_cast<size_t>(a)].name,
                       model.images[static_cast<size_t>(b)].name);
  });
  return order;
}

// The right pictures of a rig behind all others; else the order is kept.
std::vector<int> TrackFirst(std::vector<int> order, const StereoRig& rig) {
  if (rig.is_right.empty()) return order;
  std::stable_partition(order.begin(), order.end(), [&](int image_idx) {
    return !rig.is_right[static_cast<size_t>(image_idx)];
  });
  return order;
}

}  // namespace

SequenceReport DensifySequence(const SparseModel& model, PictureSource* source,
                               const PartialDensificationOptions& options, int num_threads,
                               const SequenceCallbacks& callbacks, const StereoRig& rig) {
  SequenceState state(model, TrackFirst(SequenceOrder(model), rig), rig, source, options,
                      num_threads, callbacks);
  const int num_pictures = state.NumPictures();
  const int64_t total = num_pictures * (options.completion ? 2 : 1);

  int first = 0;
  while (state.CanStartPair(first)) {
    const int second = state.SelectSecond(first);
    if (second < num_pictures) {
      state.DensifyNewAreas(first, second);
      first = state.SelectNextFirst(first, second);
    } else {
      ++first;
    }
    if (callbacks.progress) callbacks.progress(first, total);
  }
  if (options.completion) {
    for (int position = 0; position < num_pictures; ++position) {
      state.Complete(position);
      if (callbacks.progress) callbacks.progress(num_pictures + position + 1, total);
    }
  }
  return state.TakeReport();
}

}  // namespace colmap_seapoint
