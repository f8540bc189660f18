// The time that a whole job will take, corrected as it goes (ours). Plain arithmetic on the times
// that it is given: no clock, no thread.
//
// Each kind of work has an expected count and expected seconds each. What is under way is
// extrapolated from what it has done, the more so the further it is; what is to come is multiplied
// by the pace of what is done and under way, so that a loaded machine is known after some seconds.
// The mapper's part of it does not count: a hard survey takes it ten times longer, and says nothing
// of the machine; what pictures and videos are decoded in counts half. A mapper's trial that leaves
// pictures over is followed by others: what these take on the average is added, less at the first
// trial, more at the second.
#pragma once

#include "colmap_seapoint/estimate/work_costs.h"

namespace colmap_seapoint {

class JobEstimate {
 public:
  // What is expected from now on, at first and whenever more is known: of videos, how many pictures
  // they became. What was measured stays. `done_before`: work that an earlier run has finished. It
  // counts as done, not as time left.
  void Plan(const OfWork<WorkCost>& costs, const OfWork<bool>& done_before);

  // `now`: seconds since the job began, never less than at an earlier call. Counts are taken as
  // they come: more than the total, and a total of 0, are no errors.
  void Begin(Work work, double now, int64_t total, int64_t already_done);
  void Advance(Work work, double now, int64_t done);
  void End(Work work, double now);

  double SecondsLeft(double now) const;
  // 0 to 1; never less than it was.
  double Share(double now);

  // Seconds of all finished work of a kind, over those that were expected; 0: none, or too little.
  OfWork<double> Ratios() const;

 private:
  // What is known of a kind of work.
  struct Known {
    WorkCost cost;
    double total = 0;            // of all parts that have begun, what was there already too
    double expected = 0;         // seconds of what was done here
    double seconds = 0;          // that it took
    double seconds_of_last = 0;  // part
    int num_parts = 0;
  };
  // The part that is under way.
  struct Part {
    Work work = Work::kOther;
    double begin = 0;    // seconds
    double reached = 0;  // when `done` was told
    double total = 0, already_done = 0, done = 0;
  };

  void FinishPart(double now);
  double Pace() const;
  double PartSecondsLeft(double now) const;
  double ExpectedPart(Work work, double count) const;
  double TrialSecondsOf(Work work, double now) const;

  OfWork<Known> known_;
  OfWork<bool> is_over_;  // nothing more of it is to come
  Part part_;
  double seconds_before_ = 0;  // expected of what an earlier run has done
  double share_ = 0;
};

}  // namespace colmap_seapoint
