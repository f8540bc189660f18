#include "densify/densify_pair.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/timer.h"
#include "densify/consistency.h"
#include "densify/disparity_to_cloud.h"
#include "densify/rectification.h"
#include "densify/refinement.h"
#include "densify/surface_fit.h"

namespace colmap_seapoint {

namespace {

constexpr double kSamplesPerPicture = 0.75e6;
constexpr int kSamplesPerCell = 4;         // along each side
constexpr int kMinCell = 2 * kNodeStep;    // pixels: a cell holds nodes
constexpr double kMaxRowDifference = 2.0;  // between a seed's two rect rows, pixels
constexpr int kMinWindow = 8;  // pixels: a smaller window of a picture holds nothing
// Growth only has to find the surface, at every node: what is weak is judged when it is refined.
constexpr int kGrowthWindow = 7;      // pixels
constexpr float kGrowthZncc = 0.85f;  // of min_zncc
constexpr int kSmoothing = 4;         // pixels around a sample that its plane is fitted to
constexpr float kMaxSlope = 0.75f;    // pixels of disparity a pixel, on one surface
constexpr size_t kMinSeeds = 5;            // in new areas: fewer are not worth rectifying for

bool CellIsClosed(const PairInput& input, size_t cell) {
  return !input.closed.empty() && input.closed[cell] != 0;
}

bool CellIsFree(const PairInput& input, size_t cell) {
  return !CellIsClosed(input, cell) &&
         (input.covered_range.empty() || input.covered_range[cell] == 0);
}

// The part of picture 1's window that holds free cells, with room for the correlation window, and
// what can grow from the seeds (`growth` pixels; those in covered cells are new objects there); and
// of picture 2's, the same rows.
void CutToNewAreas(const PairInput& input, const PairGeometry& geometry,
                   const std::vector<Seed>& seeds, double growth, int margin, RectWindow* window1,
                   RectWindow* window2) {
  double x_min = 1e30, x_max = -1e30, y_min = 1e30, y_max = -1e30;
  for (size_t cell = 0; cell < input.cells.Size(); ++cell) {
    if (!CellIsFree(input, cell)) continue;
    const auto rect = geometry.RectFromPixel1(input.cells.Center(cell));
    if (!rect) continue;
    x_min = std::min(x_min, rect->x());
    x_max = std::max(x_max, rect->x());
    y_min = std::min(y_min, rect->y());
    y_max = std::max(y_max, rect->y());
  }
  for (const Seed& seed : seeds) {
    x_min = std::min(x_min, seed.x - growth);
    x_max = std::max(x_max, seed.x + growth);
    y_min = std::min(y_min, seed.y - growth);
    y_max = std::max(y_max, seed.y + growth);
  }
  auto cut = [](double low, double high, int* begin, int* size) {
    const double end = std::min<double>(*begin + *size, std::ceil(high));
    const double start = std::max<double>(*begin, std::floor(low));
    *begin = static_cast<int>(start);
    *size = std::max(0, static_cast<int>(end - start));
  };
  const double reach = margin + 2 * input.cells.cell;
  cut(x_min - reach, x_max + reach, &window1->x0, &window1->width);
  const double y_low = std::max<double>(window1->y0, window2->y0);
  const double y_high =
      std::min<double>(window1->y0 + window1->height, window2->y0 + window2->height);
  for (RectWindow* window : {window1, window2}) {
    cut(std::max(y_min - reach, y_low), std::min(y_max + reach, y_high), &window->y0,
        &window->height);
  }
}

// The gate, and the cell of picture 1 that each of its nodes lies in (-1: outside).
struct GatedNodes {
  Gate gate;
  std::vector<int> cell;
};

GatedNodes MakeGate(const PairInput& input, const PairGeometry& geometry, const RectMap& map1,
                    const RectWindow& window) {
  GatedNodes gated{Gate(window, Gate::kClosed), {}};
  const SampleGrid& nodes = gated.gate.Nodes();
  gated.cell.assign(nodes.Size(), -1);
  for (int b = 0; b < nodes.height; ++b) {
    for (int a = 0; a < nodes.width; ++a) {
      const auto source = map1.Source(nodes.PixelX(a), nodes.PixelY(b));
      if (!source) continue;
      const size_t node = nodes.NodeOf(a, b);
      const size_t cell = input.cells.IndexOf(source->x(), source->y());
      gated.cell[node] = static_cast<int>(cell);
      if (CellIsClosed(input, cell)) continue;
      gated.gate[node] = Gate::kOpen;
      if (CellIsFree(input, cell)) continue;
      gated.gate[node] = static_cast<float>(
          geometry.DisparityAtRange(nodes.RectX(a), nodes.RectY(b), input.covered_range[cell]));
    }
  }
  return gated;
}

// Pixel pairs -> seeds in the rect frame; those off the epipolar line, behind the cameras or in
// cells that are closed fall away.
std::vector<Seed> MakeSeeds(const PairInput& input, const PairGeometry& geometry) {
  std::vector<Seed> seeds;
  for (const PixelPair& pair : input.seeds) {
    const size_t cell = input.cells.IndexOf(pair.pixel1.x(), pair.pixel1.y());
    if (CellIsClosed(input, cell)) continue;
    const auto rect1 = geometry.RectFromPixel1(pair.pixel1);
    const auto rect2 = geometry.RectFromPixel2(pair.pixel2);
    if (!rect1 || !rect2 || std::abs(rect1->y() - rect2->y()) > kMaxRowDifference) continue;
    const Seed seed{rect1->x(), rect1->y(), rect1->x() - rect2->x()};
    if (seed.disparity < 1) continue;
    if (!CellIsFree(input, cell)) {
      const double covered =
          geometry.DisparityAtRange(seed.x, seed.y, input.covered_range[cell]);
      if (!Gate::Admits(static_cast<float>(covered), static_cast<float>(seed.disparity))) {
        continue;
      }
    }
    seeds.push_back(seed);
  }
  return seeds;
}

PairResult Failed(const std::string& why) {
  PairResult result;
  result.failure = why;
  return result;
}

}  // namespace

int SampleStep(const Camera& camera, const PartialDensificationOptions& options) {
  if (options.step > 0) return options.step;
  const double pixels = static_cast<double>(camera.width) * camera.height;
  return std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / kSamplesPerPicture))));
}

CellGrid CellsOf(const Camera& camera, const PartialDensificationOptions& options) {
  const int cell = std::max(kMinCell, kSamplesPerCell * SampleStep(camera, options));
  return CellGrid(camera.width, camera.height, cell);
}

PairResult DensifyPair(const PairInput& input, const PartialDensificationOptions& options,
                       int num_threads) {
  const auto geometry = MakePairGeometry(input.view1.camera, input.view1.cam_from_world,
                                         input.view2.camera, input.view2.cam_from_world);
  if (!geometry) return Failed("the cameras look along their baseline or coincide");
  const std::vector<Seed> seeds = MakeSeeds(input, *geometry);
  if (seeds.size() < kMinSeeds) return Failed("too few seeds in areas that are new");

  const Timer rectification_timer;
  RectWindow window1 = WindowOfPicture(*geometry, false);
  RectWindow window2 = WindowOfPicture(*geometry, true);
  const double longer_side = std::max(input.view1.camera.width, input.view1.camera.height);
  CutToNewAreas(input, *geometry, seeds, options.max_expansion * longer_side,
                options.window_size / 2, &window1, &window2);
  if (std::min(window1.width, window2.width) < kMinWindow || window1.height < kMinWindow) {
    return Failed("the pictures do not overlap");
  }
  const RectMap map1(*geometry, false, window1, num_threads);
  const RectMap map2(*geometry, true, window2, num_threads);
  const RectPicture picture1 = map1.Rectify(*input.gray1, num_threads);
  const RectPicture picture2 = map2.Rectify(*input.gray2, num_threads);
  const GatedNodes nodes = MakeGate(input, *geometry, map1, window1);
  PairResult result;
  result.rectification_seconds = rectification_timer.WallSeconds();

  const Timer propagation_timer;
  const float min_zncc = static_cast<float>(options.min_zncc);
  const int max_generations = std::max(
      1, static_cast<int>(options.max_expansion * longer_side / kNodeStep) - kMaxRefinementSpread);
  PartialDisparity coarse =
      Propagate(picture1, picture2, nodes.gate, seeds,
                {kGrowthWindow, kGrowthZncc * min_zncc, max_generations}, num_threads);
  RemoveInconsistent(nodes.gate, &coarse);
  const int step = SampleStep(input.view1.camera, options);
  result.partial = Refine(picture1, picture2, coarse, {options.window_size, min_zncc, step},
                          num_threads);
  RemoveContradictions(nodes.gate, num_threads, &result.partial);
  PartialSurface surface =
      FitSurface(result.partial, std::max(2, kSmoothing / step), kMaxSlope, num_threads);
  RemoveUnsupported(&surface);
  result.propagation_seconds = propagation_timer.WallSeconds();

  result.num_seeds = static_cast<int>(seeds.size());
  result.num_failed_seeds = coarse.num_failed_seeds;
  result.cloud = MakePartialCloud(surface, *geometry, map1, *input.color1, num_threads);
  result.cloud.image_idx1 = input.view1.image_idx;
  result.cloud.image_idx2 = input.view2.image_idx;
  CellTally tally = TallyCells(surface, *geometry, nodes.cell, input.cells);
  result.filled = std::move(tally.filled);
  result.footprint = std::move(tally.footprint);
  return result;
}

}  // namespace colmap_seapoint
