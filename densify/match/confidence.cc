#include "densify/match/confidence.h"

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {

namespace {

// The deviation of the range, ground sampling distances, at which half of the points lie elsewhere.
// It is larger than two because it is that of single samples, and the plane is that of many.
constexpr double kHalfSure = 6.35;

// The errors of matching have long tails: twice the deviation makes it four times as likely that
// the point lies elsewhere. erf, which a normal distribution would ask for, is far too sure.
float ConfidenceAt(double deviation_gsd) {
  const double doubt = deviation_gsd / kHalfSure;
  return static_cast<float>(1 / (1 + doubt * doubt));
}

}  // namespace

void AssessConfidence(const PairGeometry& geometry, int num_threads, PartialSurface* surface) {
  const SampleGrid& grid = surface->grid;
  surface->confidence.assign(grid.Size(), 0);
  const double gsd_per_range = geometry.camera1.MeanFocal();
  ParallelFor(num_threads, grid.height, [&](int64_t b) {
    const size_t row = static_cast<size_t>(b) * static_cast<size_t>(grid.width);
    for (int a = 0; a < grid.width; ++a) {
      const size_t sample = row + static_cast<size_t>(a);
      const float disparity = surface->disparity[sample];
      if (disparity <= 0) continue;
      const double range_deviation = geometry.RangePerDisparity(grid.RectX(a), disparity) *
                                     static_cast<double>(surface->deviation[sample]);
      surface->confidence[sample] = ConfidenceAt(range_deviation * gsd_per_range);
    }
  });
}

}  // namespace colmap_seapoint
