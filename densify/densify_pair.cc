#include "densify/densify_pair.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/timer.h"
#include "densify/disparity_to_cloud.h"
#include "densify/rectification.h"

namespace colmap_seapoint {

namespace {

constexpr double kSamplesPerPicture = 0.75e6;
constexpr int kSamplesPerCell = 4;         // along each side
constexpr double kMaxRowDifference = 2.0;  // between a seed's two rect rows, pixels
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

// Every sample's gate (see SampleGate), and the cell of picture 1 it lies in (-1: outside).
struct GatedSamples {
  std::vector<float> gate;
  std::vector<int> cell;
};

GatedSamples MakeGate(const PairInput& input, const PairGeometry& geometry, const RectMap& map1,
                      const SampleGrid& grid) {
  GatedSamples samples{std::vector<float>(grid.Size(), SampleGate::kClosed),
                       std::vector<int>(grid.Size(), -1)};
  for (int b = 0; b < grid.height; ++b) {
    for (int a = 0; a < grid.width; ++a) {
      const auto source = map1.Source(grid.PixelX(a), grid.PixelY(b));
      if (!source) continue;
      const size_t node =
          static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
      const size_t cell = input.cells.IndexOf(source->x(), source->y());
      samples.cell[node] = static_cast<int>(cell);
      if (CellIsClosed(input, cell)) continue;
      samples.gate[node] = SampleGate::kOpen;
      if (CellIsFree(input, cell)) continue;
      // range = depth * |ray|, disparity = focal * baseline / depth.
      const double x = grid.RectX(a) / geometry.focal, y = grid.RectY(b) / geometry.focal;
      samples.gate[node] =
          static_cast<float>(geometry.focal * geometry.baseline * std::sqrt(x * x + y * y + 1) /
                             input.covered_range[cell]);
    }
  }
  return samples;
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
      const double x = seed.x / geometry.focal, y = seed.y / geometry.focal;
      const double covered = geometry.focal * geometry.baseline * std::sqrt(x * x + y * y + 1) /
                             input.covered_range[cell];
      if (!SampleGate::Admits(static_cast<float>(covered), static_cast<float>(seed.disparity))) {
        continue;
      }
    }
    seeds.push_back(seed);
  }
  return seeds;
}

RectPicture Rectify(const RectMap& map, const RectWindow& window, const GrayImage& gray,
                    int num_threads) {
  RectPicture picture;
  picture.window = window;
  map.Rectify(gray, num_threads, &picture.gray, &picture.valid);
  return picture;
}

std::vector<float> FilledShare(const PartialDisparity& partial, const std::vector<int>& cell_of,
                               size_t num_cells) {
  std::vector<int> matched(num_cells, 0), all(num_cells, 0);
  for (size_t node = 0; node < partial.disparity.size(); ++node) {
    if (cell_of[node] < 0) continue;
    ++all[static_cast<size_t>(cell_of[node])];
    if (partial.disparity[node] > 0) ++matched[static_cast<size_t>(cell_of[node])];
  }
  std::vector<float> filled(num_cells, 0);
  for (size_t cell = 0; cell < num_cells; ++cell) {
    if (all[cell] > 0)
      filled[cell] = static_cast<float>(matched[cell]) / static_cast<float>(all[cell]);
  }
  return filled;
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
  return CellGrid(camera.width, camera.height, kSamplesPerCell * SampleStep(camera, options));
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
  const int step = SampleStep(input.view1.camera, options);
  const SampleGrid grid(window1, step);
  if (grid.Size() == 0 || window2.width == 0 || window2.height == 0) {
    return Failed("the pictures do not overlap");
  }
  const RectMap map1(*geometry, false, window1, num_threads);
  const RectMap map2(*geometry, true, window2, num_threads);
  const RectPicture picture1 = Rectify(map1, window1, *input.gray1, num_threads);
  const RectPicture picture2 = Rectify(map2, window2, *input.gray2, num_threads);
  const GatedSamples samples = MakeGate(input, *geometry, map1, grid);
  PairResult result;
  result.rectification_seconds = rectification_timer.WallSeconds();

  const Timer propagation_timer;
  const PropagationOptions propagation = {
      options.window_size, static_cast<float>(options.min_zncc),
      std::max(1, static_cast<int>(options.max_expansion * longer_side / step))};
  PartialDisparity partial =
      Propagate(picture1, picture2, grid, samples.gate, seeds, propagation, num_threads);
  RemoveInconsistent(samples.gate, &partial);
  result.propagation_seconds = propagation_timer.WallSeconds();

  result.num_seeds = static_cast<int>(seeds.size());
  result.num_failed_seeds = partial.num_failed_seeds;
  result.filled = FilledShare(partial, samples.cell, input.cells.Size());
  result.cloud = MakePartialCloud(partial, *geometry, map1, *input.color1, num_threads);
  result.cloud.image_idx1 = input.view1.image_idx;
  result.cloud.image_idx2 = input.view2.image_idx;
  result.footprint = MakeFootprint(partial, *geometry, samples.cell, result.filled, input.cells);
  return result;
}

}  // namespace colmap_seapoint
