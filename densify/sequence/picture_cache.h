// The few pictures, SeaPoints and matches that the present pair and the next ones need; pictures
// are read ahead in the background. Memory does not grow with the number of pictures.
#pragma once

#include <atomic>
#include <deque>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/picture.h"
#include "densify/sequence/picture_source.h"

namespace colmap_seapoint {

class PictureCache {
 public:
  explicit PictureCache(PictureSource* source) : source_(source) {}

  // nullptr when the picture cannot be read: the reason goes to LeftOut(), once. Pictures have
  // their colours although the second one of a pair needs none: most are the first one of another
  // pair.
  std::shared_ptr<const Picture> Get(int image_idx);
  // Empty features when they cannot be had, and the reason likewise. Where none are stored, they
  // are found in the picture, which is decoded once for that and for densification.
  std::shared_ptr<const Features> GetSeaPoints(int image_idx);
  // idx1 in image_idx1's SeaPoints, idx2 in image_idx2's.
  std::shared_ptr<const FeatureMatches> GetMatches(int image_idx1, int image_idx2);
  // Starts reading in the background, unless the picture is there or on its way.
  void Prefetch(int image_idx) { Start(image_idx); }

  const std::vector<LeftOutPicture>& LeftOut() const { return left_out_; }

 private:
  using PendingPicture = std::shared_future<std::shared_ptr<const Picture>>;
  // Five are in use around a pair; more serve the completion pass, which comes back to them.
  static constexpr size_t kMinPictures = 5;
  static constexpr size_t kMaxBytes = 192'000'000;  // beyond those
  static constexpr size_t kMaxFeatures = 64;
  static constexpr size_t kMaxMatches = 32;

  struct Entry {
    int image_idx;
    std::shared_ptr<std::atomic<size_t>> num_bytes;  // 0: not there yet, or unreadable
    PendingPicture pending;
  };

  // Drops pictures until there is room for one more. What is kept depends on how far reading has
  // come; results do not.
  void MakeRoom();
  PendingPicture Start(int image_idx);
  Features ObtainSeaPoints(int image_idx);
  void LeaveOut(int image_idx, const std::string& reason);

  PictureSource* const source_;
  // Least recently used first.
  std::deque<Entry> pictures_;
  std::deque<std::pair<int, std::shared_ptr<const Features>>> features_;
  std::deque<std::pair<std::pair<int, int>, std::shared_ptr<const FeatureMatches>>> matches_;
  std::vector<LeftOutPicture> left_out_;
};

}  // namespace colmap_seapoint
