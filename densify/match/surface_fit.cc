#include "densify/match/surface_fit.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "densify/kernels/plane_kernels.h"

namespace colmap_seapoint {

namespace {

// Deviations of the wide plane against the narrow one's that noise alone does not bring about.
constexpr float kRough = 1.8f, kRoughLeast = 0.05f;  // times; plus pixels

// From the scatter about the planes, which rows begin .. end - 1 of the deviation hold.
void CompleteDeviation(const PartialDisparity& partial, int begin, int end, int full_support,
                       PartialSurface* surface) {
  const auto width = static_cast<size_t>(partial.grid.width);
  const auto full = static_cast<float>(full_support);
  const bool has_own = !partial.deviation.empty();
  for (size_t i = static_cast<size_t>(begin) * width; i < static_cast<size_t>(end) * width; ++i) {
    const float scatter = surface->deviation[i], own = has_own ? partial.deviation[i] : 0;
    const auto support = static_cast<float>(surface->support[i]);
    if (support > 0) {
      surface->deviation[i] = std::sqrt(own * own + scatter * scatter) * full / support;
    }
  }
}

}  // namespace

PartialSurface FitSurface(const PartialDisparity& partial, int radius, float max_slope,
                          int num_threads) {
  SEAPOINT_CHECK(radius >= 1 && radius <= plane::kMaxRadius);
  const SampleGrid& grid = partial.grid;
  PartialSurface surface;
  surface.grid = grid;
  surface.disparity.resize(grid.Size());
  surface.slope_x.resize(grid.Size());
  surface.slope_y.resize(grid.Size());
  surface.support.resize(grid.Size());
  surface.deviation.resize(grid.Size());
  const float tolerance = max_slope * static_cast<float>(radius * grid.step);
  constexpr int kBand = 16;  // rows a task
  ParallelFor(num_threads, (grid.height + kBand - 1) / kBand, [&](int64_t band) {
    const int begin = static_cast<int>(band) * kBand, end = std::min(grid.height, begin + kBand);
    plane::FitRows({partial.disparity.data(), grid.width, grid.height}, begin, end, radius,
                   tolerance, 1.0f / static_cast<float>(grid.step),
                   {surface.disparity.data(), surface.slope_x.data(), surface.slope_y.data(),
                    surface.deviation.data(), surface.support.data()});
    CompleteDeviation(partial, begin, end, (2 * radius + 1) * (2 * radius + 1), &surface);
  });
  return surface;
}

PartialSurface FitRoughSurface(const PartialDisparity& partial, int radius, float max_slope,
                               int num_threads) {
  PartialSurface surface = FitSurface(partial, radius, max_slope, num_threads);
  const PartialSurface narrow =
      FitSurface(partial, std::max(1, radius / 2), max_slope, num_threads);
  for (size_t i = 0; i < surface.disparity.size(); ++i) {
    if (static_cast<float>(narrow.support[i]) < plane::kMinSupport ||
        surface.deviation[i] <= kRough * narrow.deviation[i] + kRoughLeast) {
      continue;
    }
    surface.disparity[i] = narrow.disparity[i];
    surface.slope_x[i] = narrow.slope_x[i];
    surface.slope_y[i] = narrow.slope_y[i];
  }
  return surface;
}

}  // namespace colmap_seapoint
