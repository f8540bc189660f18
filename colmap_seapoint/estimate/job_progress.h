// One line of progress for a whole job, whatever part of it is under way: what is done, the share
// of all, one time left for all (ours).
#pragma once

#include <mutex>
#include <string>

#include "colmap_seapoint/estimate/job_estimate.h"

namespace colmap_seapoint {

// While it lives, all Progress speaks through it.
class JobProgress : public WorkObserver {
 public:
  JobProgress();
  // JobEstimate::Plan(), before the first work and whenever more is known; returns the seconds that
  // are left then.
  double Plan(const OfWork<WorkCost>& costs, const OfWork<bool>& done_before);
  ~JobProgress() override;
  JobProgress(const JobProgress&) = delete;
  JobProgress& operator=(const JobProgress&) = delete;

  void Begin(Work work, const std::string& label, int64_t total, int64_t already_done) override;
  void Advance(Work work, int64_t done) override;
  void End(Work work) override;
  // "34 % of the whole job, 12 min left (matches of pairs: 1,200 of 3,000)"
  std::string Line() override;
  double SecondsBetweenLines() override;

  OfWork<double> Ratios();  // JobEstimate::Ratios()

 private:
  double Now() const;  // by the work's clock (base/hold/work_clock.h), since the job began

  const double start_seconds_;
  std::mutex mutex_;  // guards all below
  JobEstimate estimate_;
  std::string label_;  // of the part that has begun last
  int64_t total_ = 0, done_ = 0;
};

}  // namespace colmap_seapoint
