#include "densify/match/plan_pair.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace colmap_seapoint {

namespace {

constexpr int kMaxFineStep = 2;          // samples farther apart: nodes are too
constexpr double kMaxRowDifference = 2;  // between a seed's two rows, pixels of picture 1
constexpr int kMinWindow = 8;            // pixels: a smaller window of a picture holds nothing
constexpr size_t kMinSeeds = 5;          // in new areas: fewer are not worth rectifying for

PairPlan Failed(const std::string& why) {
  PairPlan plan;
  plan.failure = why;
  return plan;
}

// A box of the rect plane.
struct RectBox {
  double x0 = 1e30, y0 = 1e30, x1 = -1e30, y1 = -1e30;

  void Add(double x, double y, double reach) {
    x0 = std::min(x0, x - reach);
    y0 = std::min(y0, y - reach);
    x1 = std::max(x1, x + reach);
    y1 = std::max(y1, y + reach);
  }
};

// Cuts a side of a window, `size` pixels from `begin` on, down to low .. high.
void Cut(double low, double high, int* begin, int* size) {
  const double end = std::clamp(std::ceil(high), static_cast<double>(*begin), *begin + 1.0 * *size);
  const double start = std::clamp(std::floor(low), static_cast<double>(*begin), end);
  *begin = static_cast<int>(start);
  *size = static_cast<int>(end - start);
}

// Nothing when the pair lies off its epipolar line or behind a camera.
std::optional<Seed> SeedOf(const PairGeometry& geometry, const PixelPair& pair) {
  const auto rect1 = geometry.RectFromPixel1(pair.pixel1);
  const auto rect2 = geometry.RectFromPixel2(pair.pixel2);
  if (!rect1 || !rect2) return std::nullopt;
  const double magnification =
      std::max({1.0, geometry.Magnification(rect1->x()), geometry.Magnification(rect2->x())});
  if (std::abs(rect1->y() - rect2->y()) > kMaxRowDifference * magnification) return std::nullopt;
  const Seed seed{rect1->x(), rect1->y(), rect1->x() - rect2->x()};
  if (seed.disparity < 1) return std::nullopt;
  return seed;
}

// The seeds of cells that are open; in a covered cell those that lie in front of or behind what
// covers it.
void AddSeeds(const std::vector<PixelPair>& pairs, PairPlan* plan) {
  const KnownCells& avoided = plan->avoided;
  for (const PixelPair& pair : pairs) {
    const size_t cell = avoided.grid.IndexOf(pair.pixel1.x(), pair.pixel1.y());
    if (avoided.IsClosed(cell)) continue;
    const auto seed = SeedOf(plan->geometry, pair);
    if (!seed) continue;
    if (avoided.IsCovered(cell)) {
      const CoveredBand covered = CoveredAt(plan->geometry, avoided, cell, seed->x, seed->y);
      if (!covered.Excludes(static_cast<float>(seed->disparity))) continue;
      plan->covered_seeds.push_back(*seed);
    }
    plan->seeds.push_back(*seed);
  }
}

// Those of the seeds, and beyond them by a tenth and 16 pixels.
DisparityRange RangeAround(const std::vector<Seed>& seeds) {
  double smallest = 1e30, largest = 0;
  for (const Seed& seed : seeds) {
    smallest = std::min(smallest, seed.disparity);
    largest = std::max(largest, seed.disparity);
  }
  return {static_cast<int>(0.9 * smallest) - 16, static_cast<int>(1.1 * largest) + 16};
}

// Whether a cell and its four neighbours are new: on the plane such a cell lies inside the box of
// the others.
bool IsInnerNewCell(const KnownCells& cells, size_t cell) {
  const size_t width = static_cast<size_t>(cells.grid.width);
  return cell >= width && cell + width < cells.grid.Size() && cell % width > 0 &&
         cell % width + 1 < width && cells.IsNew(cell - 1) && cells.IsNew(cell + 1) &&
         cells.IsNew(cell - width) && cells.IsNew(cell + width);
}

// The part of picture 1's window that holds new cells, and what new objects in front of covered
// ones can grow to, with the margin that correlation windows need.
RectWindow Window1(const PairPlan& plan) {
  const CellGrid& grid = plan.avoided.grid;
  const bool on_plane = plan.geometry.surface == RectSurface::kPlane;
  RectBox box;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (!plan.avoided.IsNew(cell) || (on_plane && IsInnerNewCell(plan.avoided, cell))) continue;
    const auto rect = plan.geometry.RectFromPixel1(grid.Center(cell));
    if (!rect) continue;
    const double magnification = std::max(1.0, plan.geometry.Magnification(rect->x()));
    box.Add(rect->x(), rect->y(), plan.margin + 2 * grid.cell * magnification);
  }
  for (const Seed& seed : plan.covered_seeds) box.Add(seed.x, seed.y, plan.growth + plan.margin);
  RectWindow window = WindowOfPicture(plan.geometry, false);
  Cut(box.x0, box.x1, &window.x0, &window.width);
  Cut(box.y0, box.y1, &window.y0, &window.height);
  return window;
}

// The part of picture 2's window that window 1 may match.
RectWindow Window2(const PairPlan& plan) {
  const RectWindow& window1 = plan.window1;
  RectWindow window = WindowOfPicture(plan.geometry, true);
  Cut(window1.x0 - plan.disparities.max - plan.margin,
      window1.x0 + window1.width - plan.disparities.min + plan.margin, &window.x0, &window.width);
  Cut(window1.y0, window1.y0 + window1.height, &window.y0, &window.height);
  return window;
}

bool IsTooSmall(const RectWindow& window) {
  return window.width < kMinWindow || window.height < kMinWindow;
}

}  // namespace

CoveredBand CoveredAt(const PairGeometry& geometry, const KnownCells& known, size_t cell, double x,
                      double y) {
  return {static_cast<float>(geometry.DisparityAtRange(x, y, known.FarthestCovered(cell))),
          static_cast<float>(geometry.DisparityAtRange(x, y, known.covered_range[cell]))};
}

PairPlan PlanPair(const PairInput& input, const MatchOptions& options) {
  const Camera& camera1 = input.view1.camera;
  const auto geometry = MakePairGeometry(camera1, input.view1.cam_from_world, input.view2.camera,
                                         input.view2.cam_from_world);
  if (!geometry) return Failed("the cameras coincide");
  PairPlan plan;
  plan.geometry = *geometry;
  plan.avoided.grid = input.known.grid;
  if (input.mode == DensificationMode::kPartial) plan.avoided = input.known;
  AddSeeds(input.seeds, &plan);
  if (plan.seeds.size() < kMinSeeds) return Failed("too few seeds in areas that are new");
  plan.disparities = RangeAround(plan.seeds);
  plan.growth = options.max_expansion * std::max(camera1.width, camera1.height);
  plan.node_step = options.step > kMaxFineStep ? kMaxNodeStep : kMinNodeStep;
  plan.margin = options.window_size / 2 + plan.node_step;
  plan.window1 = Window1(plan);
  plan.window2 = Window2(plan);
  if (IsTooSmall(plan.window1) || IsTooSmall(plan.window2)) {
    return Failed("the pictures do not overlap");
  }
  return plan;
}

}  // namespace colmap_seapoint
