#include "colmap_seapoint/frames/frame_chooser.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

// Around the overlap at which a frame is due: from where on the sharpest is looked for, where it is
// taken, and where one is taken that is blurred.
constexpr double kOpen = 0.08, kClose = 0.06, kGiveUp = 0.16;
// What a frame must be sharper, to be taken kOpen away from where it is due: 1 / (1 - this).
constexpr double kWorthLost = 0.3;
constexpr double kLeastWorth = 0.05;
// Looks are no further apart, so that no start of a motion is missed.
constexpr double kMaxSecondsBetweenLooks = 0.25;
constexpr int kLooksInWindow = 4;
// Nothing was lost: the next look may be this many times as far away as the last one was.
constexpr double kManyTimes = 16;
// How long a frame that matches nothing is waited through: a fish, a flash, a blur.
constexpr double kGlitchSeconds = 0.2, kBlurSeconds = 1.0;
// Times the median of the looks before it.
constexpr double kBlurred = 0.5;
constexpr size_t kNumSharpness = 31, kMinNumSharpness = 5;
constexpr size_t kMinNumPoints = 20;

}  // namespace

FrameChooser::FrameChooser(const FrameSelectionOptions& options,
                           std::function<void(const ChosenFrame&)> choose)
    : options_(options), choose_(std::move(choose)) {}

void FrameChooser::Add(const VideoFrame& frame) {
  if (reference_ && frame.seconds < next_look_.seconds && frame.index < next_look_.index) {
    if (!candidate_) return;
    const double seconds = frame.seconds - last_look_->frame.seconds;
    Consider(frame, last_look_->overlap - next_look_.overlap_rate * seconds,
             Sharpness(frame.Gray()));
    return;
  }
  Look look = {frame, ViewOf(frame.Gray()), 0};
  if (reference_) {
    Judge(std::move(look));
  } else {
    Begin(std::move(look));
  }
}

void FrameChooser::Judge(Look look) {
  look.overlap = OverlapOf(reference_->view, look.view);
  if (look.overlap == 0) return Lose(std::move(look));
  if (!is_confirmed_) Choose(0);
  sharpness_.push_back(look.view.sharpness);
  if (sharpness_.size() > kNumSharpness) sharpness_.pop_front();

  const double open = options_.overlap + kOpen;
  if (look.overlap <= open) {
    // Too fast for a look in time: the last one may be nearer to where a frame was due.
    if (!candidate_ && last_look_) {
      Consider(last_look_->frame, last_look_->overlap, last_look_->view.sharpness);
    }
    Consider(look.frame, look.overlap, look.view.sharpness);
  } else if (look.overlap > open + kOpen / 2) {
    candidate_.reset();  // the surge has brought the camera back
  }
  const double close = options_.overlap - kClose, give_up = options_.overlap - kGiveUp;
  if (candidate_ && look.overlap <= close &&
      (!IsBlurred(candidate_->sharpness) || look.overlap <= give_up)) {
    TakeCandidate();
    if (look.frame.index > reference_->frame.index) Judge(std::move(look));
    return;
  }
  PlanNextLook(look);
  last_look_ = std::move(look);
}

// The frame shows nothing that is known of the reference.
void FrameChooser::Lose(Look look) {
  if (is_confirmed_) {
    if (last_look_ && !candidate_) {
      Consider(last_look_->frame, last_look_->overlap, last_look_->view.sharpness);
    }
    const double last = last_look_ ? last_look_->frame.seconds : reference_->frame.seconds;
    const bool is_blurred = IsBlurred(look.view.sharpness);
    const double patience = is_blurred ? kBlurSeconds : kGlitchSeconds;
    if (is_blurred || !candidate_) {
      if (look.frame.seconds - last < patience) {
        next_look_ = {};
        return;
      }
    }
    if (candidate_) {
      TakeCandidate();
      return Judge(std::move(look));
    }
  }
  Begin(std::move(look));
}

void FrameChooser::TakeCandidate() {
  const Candidate candidate = *std::exchange(candidate_, std::nullopt);
  Look chosen = {candidate.frame, {}, candidate.overlap};
  if (last_look_ && last_look_->frame.index == candidate.frame.index) {
    chosen.view = std::move(last_look_->view);
  } else {
    chosen.view = ViewOf(candidate.frame.Gray());
    // It was guessed between two looks.
    const double overlap = OverlapOf(reference_->view, chosen.view);
    if (overlap > 0) chosen.overlap = overlap;
  }
  reference_ = std::move(chosen);
  last_look_.reset();
  Choose(reference_->overlap);
}

void FrameChooser::Begin(Look look) {
  reference_ = std::move(look);
  is_confirmed_ = false;
  candidate_.reset();
  last_look_.reset();
  next_look_ = {};
}

void FrameChooser::Choose(double overlap) {
  is_confirmed_ = true;
  ++num_chosen_;
  choose_({reference_->frame, overlap, reference_->view.sharpness});
}

void FrameChooser::Consider(const VideoFrame& frame, double overlap, double sharpness) {
  const double away = std::abs(overlap - options_.overlap) / kOpen;
  const double worth = sharpness * std::max(kLeastWorth, 1 - kWorthLost * away);
  if (candidate_ && worth <= candidate_->worth) return;
  candidate_ = {frame, overlap, sharpness, worth};
}

void FrameChooser::PlanNextLook(const Look& look) {
  const Look& before = last_look_ ? *last_look_ : *reference_;
  const double overlap_before = last_look_ ? last_look_->overlap : 1;
  const double seconds = look.frame.seconds - before.frame.seconds;
  const double lost = std::max(0.0, overlap_before - look.overlap);
  const double open = options_.overlap + kOpen;
  const double window = (kOpen + kClose) / kLooksInWindow;
  // Half the way: the motion may grow faster.
  const double loss = std::max(window, (look.overlap - open) / 2);
  const double share = lost > 0 ? loss / lost : kManyTimes;  // of the time since the last look
  const auto frames = static_cast<double>(look.frame.index - before.frame.index);
  next_look_.seconds = look.frame.seconds + std::min(seconds * share, kMaxSecondsBetweenLooks);
  next_look_.index = look.frame.index + static_cast<int64_t>(frames * std::min(share, kManyTimes));
  next_look_.overlap_rate = lost / std::max(seconds, 1e-6);
}

bool FrameChooser::IsBlurred(double sharpness) const {
  if (sharpness_.size() < kMinNumSharpness) return false;
  return sharpness < kBlurred * UpperMedian({sharpness_.begin(), sharpness_.end()});
}

void FrameChooser::Finish() {
  if (candidate_ && is_confirmed_) TakeCandidate();
  // A single frame, or none that goes with another: better one than nothing.
  if (reference_ && num_chosen_ == 0 && reference_->view.features.points.size() >= kMinNumPoints) {
    Choose(0);
  }
}

}  // namespace colmap_seapoint
