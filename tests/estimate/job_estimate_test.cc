#include "colmap_seapoint/estimate/job_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/estimate/job_progress.h"

namespace colmap_seapoint {
namespace {

// 100 pictures of 1 s, 200 pairs of 0.5 s, 100 registered in 1 s each and refined in as long, 300
// steps of 1 s: 100 + 100 + 200 + 300 s.
OfWork<WorkCost> PlainCosts() {
  OfWork<WorkCost> costs;
  costs[Work::kPictures] = {100, 1};
  costs[Work::kPairs] = {200, 0.5};
  costs[Work::kRegistration] = {100, 1};
  costs[Work::kRefinement] = {100, 1};
  costs[Work::kDensification] = {300, 1};
  return costs;
}

JobEstimate Planned(const OfWork<WorkCost>& costs, const OfWork<bool>& done_before = {}) {
  JobEstimate estimate;
  estimate.Plan(costs, done_before);
  return estimate;
}

// A job whose work takes `slowness` times as long as expected; the largest error of the predicted
// total, as a share of the true one, from a tenth of the job on.
class SimulatedJob {
 public:
  explicit SimulatedJob(double slowness) : slowness_(slowness) {}

  void Do(Work work, int64_t count, double seconds_each) {
    estimate_.Begin(work, now_, count, 0);
    for (int64_t i = 1; i <= count; ++i) {
      now_ += slowness_ * seconds_each;
      estimate_.Advance(work, now_, i);
      const double share = estimate_.Share(now_);
      EXPECT_GE(share, last_share_);
      EXPECT_LE(share, 1);
      last_share_ = share;
      predictions_.emplace_back(now_, now_ + estimate_.SecondsLeft(now_));
    }
    estimate_.End(work, now_);
  }

  void DoAll() {
    Do(Work::kPictures, 100, 1);
    Do(Work::kPairs, 200, 0.5);
    Do(Work::kRegistration, 100, 1);
    Do(Work::kRefinement, 100, 1);
    Do(Work::kDensification, 300, 1);
  }

  double WorstError() const {
    double worst = 0;
    for (const auto& [now, total] : predictions_) {
      if (now >= 0.1 * now_) worst = std::max(worst, std::abs(total / now_ - 1));
    }
    return worst;
  }
  double SecondsLeft() const { return estimate_.SecondsLeft(now_); }
  double Share() { return estimate_.Share(now_); }
  OfWork<double> Ratios() const { return estimate_.Ratios(); }

 private:
  double slowness_;
  double now_ = 0, last_share_ = 0;
  JobEstimate estimate_ = Planned(PlainCosts());
  std::vector<std::pair<double, double>> predictions_;
};

TEST(JobEstimate, IsWithinAThirdFromATenthOn) {
  for (const double slowness : {0.3, 1.0, 4.0}) {
    SimulatedJob job(slowness);
    job.DoAll();
    EXPECT_LT(job.WorstError(), 0.3) << slowness;
    EXPECT_NEAR(job.SecondsLeft(), 0, 1e-9);
    EXPECT_NEAR(job.Share(), 1, 1e-9);
  }
}

TEST(JobEstimate, TellsTheRatioOfWhatWorkTook) {
  SimulatedJob job(4);
  job.DoAll();
  for (const Work work :
       {Work::kPictures, Work::kPairs, Work::kRegistration, Work::kDensification}) {
    EXPECT_NEAR(job.Ratios()[work], 4, 0.01);
  }
  EXPECT_EQ(job.Ratios()[Work::kLookAlikes], 0);
}

// Ten pictures in, of a job of 700 s that a loaded machine stretches: all that is to come is
// corrected by what these took.
TEST(JobEstimate, ALoadedMachineIsKnownFromTheFirstPictures) {
  for (const double slowness : {0.5, 2.0, 5.0}) {
    JobEstimate estimate = Planned(PlainCosts());
    estimate.Begin(Work::kPictures, 0, 100, 0);
    estimate.Advance(Work::kPictures, 10 * slowness, 10);
    // The trials of the mapper that may follow the first one are in it, by 0.4 of that.
    EXPECT_NEAR(estimate.SecondsLeft(10 * slowness), slowness * (690 + 0.4 * 200),
                0.12 * slowness * 770)
        << slowness;
  }
}

TEST(JobEstimate, HalfOfWhatDecodingTookIsTheMachines) {
  OfWork<WorkCost> costs = PlainCosts();
  costs[Work::kIntake] = {100, 1};
  JobEstimate estimate = Planned(costs);
  const double before = estimate.SecondsLeft(0) - 100;
  estimate.Begin(Work::kIntake, 0, 100, 0);
  estimate.Advance(Work::kIntake, 400, 100);
  estimate.End(Work::kIntake, 400);
  EXPECT_NEAR(estimate.SecondsLeft(400), 2 * before, 0.02 * before);
}

// Of each kind: what has begun counts, also where none of it was planned.
TEST(JobEstimate, NoWorkIsOutsideThePlan) {
  OfWork<WorkCost> costs;
  for (WorkCost& cost : costs.values) cost.seconds_each = 1;
  for (int i = 0; i < kNumWorks; ++i) {
    const auto work = static_cast<Work>(i);
    // The mapper has rules of its own, which the tests below ask for.
    if (work == Work::kOther || work == Work::kRegistration || work == Work::kRefinement) continue;
    JobEstimate estimate = Planned(costs);
    estimate.Begin(work, 0, 10, 0);
    EXPECT_GE(estimate.SecondsLeft(0), 9.9) << i;
    estimate.Advance(work, 5, 5);
    EXPECT_NEAR(estimate.Share(5), 0.5, 0.1) << i;
    estimate.End(work, 10);
  }
}

// A video becomes more, or fewer, pictures than were expected.
TEST(JobEstimate, ANewPlanNeverMovesTheShareBack) {
  for (const int64_t factor : {1, 10}) {
    OfWork<WorkCost> costs = PlainCosts();
    costs[Work::kIntake] = {100, 1};
    JobEstimate estimate = Planned(costs);
    estimate.Begin(Work::kIntake, 0, 100, 0);
    estimate.Advance(Work::kIntake, 100, 100);
    estimate.End(Work::kIntake, 100);
    const double share = estimate.Share(100);
    EXPECT_GT(share, 0.1);
    costs = PlainCosts();
    for (WorkCost& cost : costs.values) cost.count *= factor;
    OfWork<bool> done;
    done[Work::kPictures] = true;
    estimate.Plan(costs, done);
    EXPECT_GE(estimate.Share(100), share);
    const auto count = static_cast<double>(factor);
    EXPECT_NEAR(estimate.SecondsLeft(100), count * (600 + 0.4 * 200), 0.3 * count * 600);
    estimate.Begin(Work::kPairs, 100, 200 * factor, 0);  // nothing of the intake is left over
    EXPECT_NEAR(estimate.SecondsLeft(100), count * (600 + 0.4 * 200), 0.3 * count * 600);
  }
}

TEST(JobEstimate, AHardMapperSaysNothingOfTheMachine) {
  JobEstimate estimate = Planned(PlainCosts());
  estimate.Begin(Work::kRegistration, 0, 100, 0);
  estimate.Advance(Work::kRegistration, 5000, 100);
  estimate.End(Work::kRegistration, 5000);
  estimate.Begin(Work::kDensification, 6000, 300, 0);
  EXPECT_NEAR(estimate.SecondsLeft(6000), 300, 1);
}

TEST(JobEstimate, ASecondTrialIsExpectedToTakeLongerAndToBeFollowed) {
  JobEstimate estimate = Planned(PlainCosts());
  const auto trial = [&](double begin, double end) {
    estimate.Begin(Work::kRegistration, begin, 100, 0);
    estimate.Advance(Work::kRegistration, end, 100);
    estimate.End(Work::kRegistration, end);
  };
  trial(0, 100);
  const double after_one = estimate.SecondsLeft(200);
  estimate.Begin(Work::kRegistration, 200, 100, 0);
  EXPECT_GT(estimate.SecondsLeft(200), after_one + 200);
}

TEST(JobEstimate, APilotIsNoTrial) {
  JobEstimate with_pilot = Planned(PlainCosts()), without = Planned(PlainCosts());
  with_pilot.Begin(Work::kRegistration, 0, 60, 0);
  with_pilot.Advance(Work::kRegistration, 100, 60);
  with_pilot.End(Work::kRegistration, 100);
  with_pilot.Begin(Work::kRegistration, 100, 100, 0);
  without.Begin(Work::kRegistration, 100, 100, 0);
  EXPECT_NEAR(with_pilot.SecondsLeft(100), without.SecondsLeft(100), 1e-6);
}

TEST(JobEstimate, WhatAnEarlierRunDidCountsAsDone) {
  OfWork<bool> done;
  done[Work::kPictures] = done[Work::kPairs] = true;
  done[Work::kRegistration] = done[Work::kRefinement] = true;
  JobEstimate estimate = Planned(PlainCosts(), done);
  EXPECT_NEAR(estimate.SecondsLeft(0), 300, 1e-6);
  EXPECT_NEAR(estimate.Share(0), 400.0 / 700, 1e-6);
  // What is there already is no measure of speed.
  estimate.Begin(Work::kPairs, 0, 200, 199);
  estimate.Advance(Work::kPairs, 0.5, 200);
  estimate.End(Work::kPairs, 0.5);
  EXPECT_NEAR(estimate.SecondsLeft(1), 300, 1e-6);
}

TEST(JobEstimate, OddCountsAreNoErrors) {
  JobEstimate estimate = Planned(OfWork<WorkCost>());
  EXPECT_EQ(estimate.SecondsLeft(0), 0);
  estimate.Begin(Work::kPictures, 0, 0, 0);
  estimate.Advance(Work::kPictures, 0.5, 7);
  estimate.Begin(Work::kPairs, 1, 5, 9);
  estimate.Advance(Work::kPairs, 2, 3);
  estimate.Advance(Work::kPictures, 2, 3);  // not under way
  estimate.End(Work::kOther, 2);
  EXPECT_TRUE(std::isfinite(estimate.SecondsLeft(3)));
  EXPECT_GE(estimate.Share(3), 0);
  estimate.Begin(Work::kRegistration, 3, -1, 0);
  EXPECT_TRUE(std::isfinite(estimate.SecondsLeft(3)));
}

// The line of the whole job stands in for that of its parts.
TEST(JobProgress, SpeaksForAllParts) {
  JobProgress job;
  job.Plan(PlainCosts(), {});
  Progress part("Matches of pairs", 200, 0, Work::kPairs);
  part.Update(50);
  const std::string line = job.Line();
  EXPECT_NE(line.find(" % of the whole job, about "), std::string::npos) << line;
  EXPECT_NE(line.find("(Matches of pairs: 50 of 200)"), std::string::npos) << line;
  EXPECT_GE(job.SecondsBetweenLines(), 1);
  EXPECT_LE(job.SecondsBetweenLines(), kMaxSilenceSeconds);
}

// Nothing is counted for a while: the heartbeat speaks all the same.
TEST(JobProgress, TheHeartbeatBreaksTheSilence) {
  testing::internal::CaptureStderr();
  {
    const Heartbeat heartbeat;
    OfWork<WorkCost> costs;
    costs[Work::kRegistration] = {10, 0.1};  // a line a second
    JobProgress job;
    job.Plan(costs, {});
    Progress part("Pictures registered", 10, 0, Work::kRegistration);
    std::this_thread::sleep_for(std::chrono::milliseconds(2200));
  }
  EXPECT_NE(testing::internal::GetCapturedStderr().find("(Pictures registered: 0 of 10)"),
            std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
