#include "colmap_seapoint/estimate/work_costs.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

// CPU seconds, medians of the runs that the costs were measured on: 4 to 3000 pictures of 0.2 to 20
// megapixels.
constexpr double kCopiedMegapixelSeconds = 0.08;   // decoded and written as JPEG
constexpr double kVideoMegapixelSeconds = 0.0045;  // decoded; one frame in ten looked at
constexpr double kPictureSeconds = 0.003;
constexpr double kMegapixelSeconds = 0.008;
constexpr double kLookAlikeSeconds = 0.008;
constexpr double kLookAlikeGrowth = 4e-6;  // more for each picture that is compared with
constexpr double kPairSeconds = 0.012;
constexpr double kMarkerMegapixelSeconds = 0.05;
constexpr double kTiltedViewSeconds = 0.1;
constexpr double kJoiningSeconds = 1;
constexpr double kRegistrationSeconds = 0.09;
constexpr double kRegistrationGrowth = 2e-5;  // more for each picture of the model
constexpr double kRefinementSeconds = 0.05;
constexpr double kStepsOfPicture = 3;  // of the densifier: once in the track, twice afterwards
constexpr double kDensifiedMegapixels = 0.75;
constexpr double kDensifiedMegapixelSeconds = 0.35;
constexpr double kRectifiedMegapixelSeconds = 0.06;
constexpr double kMapSeconds = 0.05;
constexpr double kOrthomosaicSeconds = 0.01;
constexpr double kOrthomosaicMegapixelSeconds = 0.19;
constexpr double kStepsOfCompleteness = 3;  // of a picture: itself, and twice its part of the cloud
constexpr double kCompletenessSeconds = 0.01;
constexpr double kCompletenessMegapixelSeconds = 0.14;

// How many threads are kept busy, of those that there are. The mapper has one.
double Busy(int num_threads) { return 0.15 + 0.85 * std::max(num_threads, 1); }

}  // namespace

int64_t ExpectedSequentialPairs(int64_t num_pictures, int overlap, bool finds_look_alikes) {
  return num_pictures * (finds_look_alikes ? 2 * overlap + 1 : overlap);
}

OfWork<WorkCost> ExpectedCosts(const JobSize& size, const OfWork<double>& machine) {
  const auto n = static_cast<double>(size.num_pictures);
  const double megapixels = size.megapixels / std::max(n, 1.0);
  const double threads = Busy(size.num_threads);
  OfWork<WorkCost> costs;
  const auto set = [&](Work work, double count, double seconds_each) {
    costs[work] = {std::llround(count), seconds_each * machine[work]};
  };
  const auto num_taken_in = static_cast<double>(size.num_copies + size.video_seconds);
  set(Work::kIntake, num_taken_in,
      size.decoded_megapixels *
          (size.num_copies > 0 ? kCopiedMegapixelSeconds : kVideoMegapixelSeconds) /
          std::max(num_taken_in, 1.0) / threads);
  set(Work::kPictures, n, (kPictureSeconds + kMegapixelSeconds * megapixels) / threads);
  if (size.finds_look_alikes) {
    set(Work::kLookAlikes, n, (kLookAlikeSeconds + kLookAlikeGrowth * n) / threads);
  }
  set(Work::kPairs, static_cast<double>(size.num_pairs), kPairSeconds / threads);
  set(Work::kMarkers, size.finds_markers ? n : 0, kMarkerMegapixelSeconds * megapixels / threads);
  set(Work::kTiltedViews, 0, kTiltedViewSeconds / threads);
  set(Work::kJoining, 0, kJoiningSeconds);
  set(Work::kRegistration, n, kRegistrationSeconds + kRegistrationGrowth * n);
  set(Work::kRefinement, n, kRefinementSeconds);
  const double densified = kDensifiedMegapixelSeconds * std::min(megapixels, kDensifiedMegapixels) +
                           kRectifiedMegapixelSeconds * megapixels;
  set(Work::kDensification, kStepsOfPicture * n, densified / kStepsOfPicture / threads);
  if (size.writes_maps) set(Work::kMaps, n, kMapSeconds * megapixels / threads);
  if (size.makes_map) {
    set(Work::kOrthomosaic, n,
        (kOrthomosaicSeconds + kOrthomosaicMegapixelSeconds * megapixels) / threads);
  }
  if (size.reports_completeness) {
    set(Work::kCompleteness, kStepsOfCompleteness * n,
        (kCompletenessSeconds + kCompletenessMegapixelSeconds * megapixels) / kStepsOfCompleteness /
            threads);
  }
  return costs;
}

}  // namespace colmap_seapoint
