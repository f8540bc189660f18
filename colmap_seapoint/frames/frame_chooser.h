// Chooses the frames of a video that a reconstruction needs (the paper's spatial sampling; the
// rules are ours). A frame is due when its overlap with the last chosen one has fallen to what the
// options say, and the sharpest near that place is taken: a diver who stands still adds no frame,
// one who swims fast adds many.
//
// Where a frame cannot be matched with the last chosen one, the last that could is taken, and the
// choice goes on from there; where that does not help either, the track is lost and begins anew
// with the first frame that the next one can be matched with. So stretches of empty water give no
// frames.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "colmap_seapoint/frames/frame_options.h"
#include "colmap_seapoint/frames/frame_view.h"
#include "colmap_seapoint/io/video/video_file.h"

namespace colmap_seapoint {

struct ChosenFrame {
  VideoFrame frame;
  double overlap = 0;  // with the one chosen before it; 0: none, a track begins here
  double sharpness = 0;
};

// Frames are given in their order. At most four of them are kept at a time. Cost: 6 CPU ms a frame
// that is looked at, about six for each chosen one, and 2 ms for each of those from which the
// sharpest is taken.
class FrameChooser {
 public:
  // `choose` is called with every chosen frame, in their order, some frames late.
  FrameChooser(const FrameSelectionOptions& options,
               std::function<void(const ChosenFrame&)> choose);

  void Add(const VideoFrame& frame);
  // No frame comes any more.
  void Finish();

 private:
  struct Look {
    VideoFrame frame;
    FrameView view;
    double overlap = 0;  // with the reference
  };
  struct Candidate {
    VideoFrame frame;
    double overlap = 0, sharpness = 0, worth = 0;
  };

  // When the next frame is looked at: at the first of both.
  struct NextLook {
    double seconds = 0;
    int64_t index = 0;
    double overlap_rate = 0;  // that is lost a second
  };

  void Judge(Look look);
  void Lose(Look look);
  void TakeCandidate();
  void Begin(Look look);
  void Choose(double overlap);  // the reference
  void Consider(const VideoFrame& frame, double overlap, double sharpness);
  void PlanNextLook(const Look& look);
  bool IsBlurred(double sharpness) const;

  FrameSelectionOptions options_;
  std::function<void(const ChosenFrame&)> choose_;
  std::optional<Look> reference_;  // the last chosen frame, or the first of a track to be
  bool is_confirmed_ = false;      // the reference has been chosen
  std::optional<Candidate> candidate_;
  std::optional<Look> last_look_;  // that was matched with the reference
  std::deque<double> sharpness_;   // of the last looks
  NextLook next_look_;
  int64_t num_chosen_ = 0;
};

}  // namespace colmap_seapoint
