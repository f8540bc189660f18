#include "colmap_seapoint/estimate/job_estimate.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace colmap_seapoint {
namespace {

// Trials of the mapper that are expected to follow the first, the second ... one, in units of the
// one that runs. One set in three has more than one trial; it then has three or four, of which the
// second is that of all matches.
constexpr double kTrialsToCome[] = {0.4, 1.4, 0.5, 0};
constexpr double kTrialsToComeOfMany = 0.2;  // after the first one
constexpr int64_t kManyPictures = 120;
constexpr double kSecondTrial = 2.5;  // as long as the first one
constexpr double kLaterTrial = 1.2;   // as long as the one before
// Of a part: where the extrapolation counts as much as what was expected.
constexpr double kFirmShare = 0.06;
constexpr double kFirmShareOfUneven = 0.15;  // the first steps of mapper and densifier are slow
// Seconds of work that the machine is taken to have done at the expected pace.
constexpr double kPriorSeconds = 0.25;
constexpr double kMaxPace = 30;
// Matching hard pairs takes longer, on any machine: what it takes beyond this multiple of the
// pictures' pace says nothing of the machine.
constexpr double kPairsToPictures = 2.5;
constexpr double kMinPictureSeconds = 0.02;  // of work, that show a pace
constexpr double kMinRatioSeconds = 0.5;     // for the history

constexpr Work kPlanned[] = {Work::kIntake,        Work::kPictures,   Work::kLookAlikes,
                             Work::kPairs,         Work::kMarkers,    Work::kTiltedViews,
                             Work::kRegistration,  Work::kRefinement, Work::kJoining,
                             Work::kDensification, Work::kMaps,       Work::kOrthomosaic,
                             Work::kCompleteness};

// A hard survey takes them ten times longer, which says nothing of the machine.
bool IsMappers(Work work) { return work == Work::kRegistration || work == Work::kRefinement; }
bool SaysNothingOfMachine(Work work) { return IsMappers(work) || work == Work::kJoining; }

// The mapper's work for a model that has this share of its pictures: it adjusts all of them again
// and again.
double ShareOfWork(Work work, double share) {
  return work == Work::kRegistration ? std::pow(share, 1.2) : share;
}

// While the trial of this number, from 1 on, runs; 0: while none has begun.
double TrialsToCome(int trial, int64_t num_pictures) {
  const auto num_before = static_cast<size_t>(std::max(0, trial - 1));
  if (num_before == 0 && num_pictures >= kManyPictures) return kTrialsToComeOfMany;
  return kTrialsToCome[std::min(num_before, std::size(kTrialsToCome) - 1)];
}

}  // namespace

void JobEstimate::Plan(const OfWork<WorkCost>& costs, const OfWork<bool>& done_before) {
  seconds_before_ = 0;
  for (const Work work : kPlanned) {
    known_[work].cost = costs[work];
    // What has begun here is judged by what it does here.
    if (known_[work].num_parts > 0) continue;
    is_over_[work] = done_before[work];
    const double seconds = static_cast<double>(costs[work].count) * costs[work].seconds_each;
    if (done_before[work]) seconds_before_ += seconds;
  }
}

// A refinement consists of several adjustments, with other work between them. A pilot of fewer
// pictures comes before the mapper's first trial; each trial has a refinement of its own.
void JobEstimate::Begin(Work work, double now, int64_t total, int64_t already_done) {
  if (work == Work::kOther || (work == Work::kRefinement && part_.work == work)) return;
  FinishPart(now);
  if (work == Work::kRegistration) {
    if (static_cast<double>(total) > known_[work].total) known_[work].num_parts = 0;
    known_[work].total = 0;
    is_over_[Work::kRefinement] = false;
  }
  for (const Work earlier : kPlanned) {
    if (earlier < work) is_over_[earlier] = true;
  }
  is_over_[work] = false;
  Known& known = known_[work];
  ++known.num_parts;
  known.total += static_cast<double>(std::max<int64_t>(total, 0));
  const auto already = static_cast<double>(already_done);
  part_ = {work, now, now, static_cast<double>(total), already, already};
}

void JobEstimate::Advance(Work work, double now, int64_t done) {
  // The mapper counts from the beginning again when it begins another model.
  if (work != part_.work || !(static_cast<double>(done) > part_.done)) return;
  part_.done = static_cast<double>(done);
  part_.reached = now;
}

void JobEstimate::End(Work work, double now) {
  if (work != part_.work || work == Work::kRefinement) return;
  FinishPart(now);
  if (work == Work::kRegistration) Begin(Work::kRefinement, now, 0, 0);
}

void JobEstimate::FinishPart(double now) {
  Known& known = known_[part_.work];
  known.seconds_of_last = now - part_.begin;
  known.seconds += known.seconds_of_last;
  known.expected += known.cost.seconds_each * (part_.work == Work::kRefinement
                                                   ? static_cast<double>(known.cost.count)
                                                   : part_.done - part_.already_done);
  part_ = Part();
}

double JobEstimate::Pace() const {
  double expected = kPriorSeconds, seconds = kPriorSeconds, pace_of_pictures = 1;
  for (const Work work : kPlanned) {
    if (SaysNothingOfMachine(work)) continue;
    double expected_of_work = known_[work].expected, seconds_of_work = known_[work].seconds;
    if (work == part_.work) {
      expected_of_work += (part_.done - part_.already_done) * known_[work].cost.seconds_each;
      seconds_of_work += part_.reached - part_.begin;
    }
    const double max_pace =
        work == Work::kPairs ? kPairsToPictures * std::max(1.0, pace_of_pictures) : kMaxPace;
    seconds_of_work = std::min(seconds_of_work, max_pace * expected_of_work);
    // How large a codec's pictures are and how it packs them is not known beforehand.
    if (work == Work::kIntake) seconds_of_work = std::sqrt(seconds_of_work * expected_of_work);
    if (work == Work::kPictures && expected_of_work > kMinPictureSeconds) {
      pace_of_pictures = seconds_of_work / expected_of_work;
    }
    expected += expected_of_work;
    seconds += seconds_of_work;
  }
  return seconds / expected;
}

double JobEstimate::ExpectedPart(Work work, double count) const {
  const Known& known = known_[work];
  const double cost = count * known.cost.seconds_each;
  if (!IsMappers(work)) return Pace() * cost;
  // While a trial runs, num_parts counts it.
  const int num_before =
      known_[Work::kRegistration].num_parts - (part_.work == Work::kOther ? 0 : 1);
  if (num_before <= 0 || known.seconds_of_last <= 0) return Pace() * cost;
  if (work == Work::kRefinement) return known.seconds_of_last;
  return known.seconds_of_last * (num_before == 1 ? kSecondTrial : kLaterTrial);
}

// With what little it has done, a part takes at least half as long again as nothing was heard of
// it.
double JobEstimate::PartSecondsLeft(double now) const {
  const double elapsed = std::max(now - part_.begin, 0.0);
  if (part_.work == Work::kRefinement) {
    const auto count = static_cast<double>(known_[part_.work].cost.count);
    const double whole = ExpectedPart(part_.work, count);
    return whole <= 0 ? 0 : whole * whole / (whole + elapsed);
  }
  const double to_do = std::max(part_.total - part_.already_done, 0.0);
  const double share =
      to_do > 0 ? std::clamp((part_.done - part_.already_done) / to_do, 0.0, 1.0) : 1.0;
  const double worked = ShareOfWork(part_.work, share);
  const double expected =
      std::max(ExpectedPart(part_.work, to_do) * (1 - worked), share > 0 ? 0 : 0.5 * elapsed);
  if (worked <= 0) return expected;
  const bool is_uneven = part_.work == Work::kRegistration || part_.work == Work::kDensification;
  const double weight = worked / (worked + (is_uneven ? kFirmShareOfUneven : kFirmShare));
  return (1 - weight) * expected + weight * elapsed * (1 - worked) / worked;
}

// Of the trial that runs, or else of the next one.
double JobEstimate::TrialSecondsOf(Work work, double now) const {
  if (work == part_.work) return now - part_.begin + PartSecondsLeft(now);
  if (part_.work == Work::kRefinement) return known_[work].seconds_of_last;
  return ExpectedPart(work, static_cast<double>(known_[work].cost.count));
}

double JobEstimate::SecondsLeft(double now) const {
  double left = part_.work == Work::kOther ? 0 : PartSecondsLeft(now);
  for (const Work work : kPlanned) {
    const Known& known = known_[work];
    if (is_over_[work]) continue;
    if (IsMappers(work)) {
      left += work == part_.work ? 0 : TrialSecondsOf(work, now);
    } else {
      left +=
          ExpectedPart(work, std::max(static_cast<double>(known.cost.count) - known.total, 0.0));
    }
  }
  if (is_over_[Work::kRefinement]) return left;
  const Known& trials = known_[Work::kRegistration];
  return left +
         TrialsToCome(trials.num_parts, trials.cost.count) *
             (TrialSecondsOf(Work::kRegistration, now) + TrialSecondsOf(Work::kRefinement, now));
}

double JobEstimate::Share(double now) {
  const double behind = seconds_before_ + now;
  const double whole = behind + SecondsLeft(now);
  if (whole > 0) share_ = std::max(share_, std::clamp(behind / whole, 0.0, 1.0));
  return share_;
}

OfWork<double> JobEstimate::Ratios() const {
  OfWork<double> ratios;
  for (const Work work : kPlanned) {
    const Known& known = known_[work];
    if (known.seconds < kMinRatioSeconds || !(known.expected > 0)) continue;
    ratios[work] = known.seconds / known.expected;
  }
  return ratios;
}

}  // namespace colmap_seapoint
