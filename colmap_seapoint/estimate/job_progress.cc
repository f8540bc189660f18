#include "colmap_seapoint/estimate/job_progress.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/hold/work_clock.h"
#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {
namespace {

constexpr double kLinesOfJob = 25;
constexpr double kMinLineSeconds = 1;

}  // namespace

JobProgress::JobProgress() : start_seconds_(WorkSeconds()) { SetWorkObserver(this); }

JobProgress::~JobProgress() { SetWorkObserver(nullptr); }

double JobProgress::Now() const { return WorkSeconds() - start_seconds_; }

double JobProgress::Plan(const OfWork<WorkCost>& costs, const OfWork<bool>& done_before) {
  std::lock_guard<std::mutex> lock(mutex_);
  estimate_.Plan(costs, done_before);
  return estimate_.SecondsLeft(Now());
}

void JobProgress::Begin(Work work, const std::string& label, int64_t total, int64_t already_done) {
  std::lock_guard<std::mutex> lock(mutex_);
  estimate_.Begin(work, Now(), total, already_done);
  label_ = label;
  total_ = total;
  done_ = already_done;
}

void JobProgress::Advance(Work work, int64_t done) {
  std::lock_guard<std::mutex> lock(mutex_);
  estimate_.Advance(work, Now(), done);
  done_ = done;
}

void JobProgress::End(Work work) {
  std::lock_guard<std::mutex> lock(mutex_);
  estimate_.End(work, Now());
}

std::string JobProgress::Line() {
  std::lock_guard<std::mutex> lock(mutex_);
  const double now = Now();
  // All but the last line is below 100 %.
  const int percent = std::min(99, static_cast<int>(100 * estimate_.Share(now)));
  std::string line = std::to_string(percent) + " % of the whole job, about " +
                     DurationText(estimate_.SecondsLeft(now)) + " left";
  if (label_.empty()) return line;
  line += " (" + label_;
  if (total_ > 0) line += ": " + std::to_string(done_) + " of " + std::to_string(total_);
  return line + ")";
}

double JobProgress::SecondsBetweenLines() {
  std::lock_guard<std::mutex> lock(mutex_);
  const double now = Now();
  return std::clamp((now + estimate_.SecondsLeft(now)) / kLinesOfJob, kMinLineSeconds,
                    kMaxSilenceSeconds);
}

OfWork<double> JobProgress::Ratios() {
  std::lock_guard<std::mutex> lock(mutex_);
  return estimate_.Ratios();
}

}  // namespace colmap_seapoint
