// The few pictures, SeaPoints and matches that the present pair and the next ones need; pictures
// are read ahead in the background. Memory does not grow with the number of pictures.
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"
#include "densify/densify_sequence.h"

namespace colmap_seapoint {

struct Picture {
  ColorImage color;  // empty when only grey was asked for
  GrayImage gray;    // 0.299 red + 0.587 green + 0.114 blue
};

class PictureCache {
 public:
  PictureCache(PictureSource* source, size_t max_pictures)
      : source_(source), max_pictures_(max_pictures) {}

  // nullptr when the picture cannot be read: the reason goes to LeftOut(), once. Of the second
  // picture of a pair only the grey values are needed: decoding them costs half.
  std::shared_ptr<const Picture> Get(int image_idx) { return Wait(image_idx, true); }
  std::shared_ptr<const Picture> GetGray(int image_idx) { return Wait(image_idx, false); }
  // Colours for a look, past the cache: what it holds decides where grey values come from. Empty
  // when the picture cannot be read.
  ColorImage ReadAside(int image_idx);
  // Empty features when they cannot be had, and the reason likewise. Where none are stored, they
  // are found in the picture, which is decoded once for that and for densification.
  std::shared_ptr<const Features> GetSeaPoints(int image_idx);
  // idx1 in image_idx1's SeaPoints, idx2 in image_idx2's.
  std::shared_ptr<const FeatureMatches> GetMatches(int image_idx1, int image_idx2);
  // Starts reading in the background, if it is not there or under way.
  void Prefetch(int image_idx) { Start(image_idx, true); }
  void PrefetchGray(int image_idx) { Start(image_idx, false); }

  const std::vector<LeftOutPicture>& LeftOut() const { return left_out_; }

 private:
  using PendingPicture = std::shared_future<std::shared_ptr<const Picture>>;
  static constexpr size_t kMaxFeatures = 32;
  static constexpr size_t kMaxMatches = 32;

  struct Entry {
    int image_idx;
    bool with_color;
    PendingPicture pending;
  };

  PendingPicture Start(int image_idx, bool with_color);
  std::shared_ptr<const Picture> Wait(int image_idx, bool with_color);
  Features ObtainSeaPoints(int image_idx);
  void LeaveOut(int image_idx, const std::string& reason);

  PictureSource* const source_;
  const size_t max_pictures_;
  // Least recently used first.
  std::deque<Entry> pictures_;
  std::deque<std::pair<int, std::shared_ptr<const Features>>> features_;
  std::deque<std::pair<std::pair<int, int>, std::shared_ptr<const FeatureMatches>>> matches_;
  std::vector<LeftOutPicture> left_out_;
};

}  // namespace colmap_seapoint
