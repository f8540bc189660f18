#include "densify/densify_pair.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/timer.h"
#include "densify/cloud/disparity_to_cloud.h"
#include "densify/match/consistency.h"
#include "densify/match/rectification.h"
#include "densify/match/refinement.h"
#include "densify/match/surface_fit.h"

namespace colmap_seapoint {

namespace {

constexpr double kSamplesPerPicture = 0.75e6;
constexpr int kSamplesPerCell = 4;          // along each side
constexpr int kMinCell = 2 * kMinNodeStep;  // pixels: a cell holds nodes
constexpr int kMaxFineStep = 2;             // samples farther apart: nodes are too
constexpr double kMaxRowDifference = 2.0;   // between a seed's two rect rows, pixels
constexpr int kMinWindow = 8;               // pixels: a smaller window of a picture holds nothing
// Growth only has to find the surface, at every node: what is weak is judged when it is refined.
constexpr int kGrowthWindow = 7;      // pixels
constexpr float kGrowthZncc = 0.85f;  // of min_zncc
constexpr int kSmoothing = 4;         // pixels around a sample that its plane is fitted to
constexpr float kMaxSlope = 0.75f;    // pixels of disparity a pixel, on one surface
constexpr size_t kMinSeeds = 5;       // in new areas: fewer are not worth rectifying for

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

void Cut(double low, double high, int* begin, int* size) {
  const double end = std::clamp(std::ceil(high), static_cast<double>(*begin), *begin + 1.0 * *size);
  const double start = std::clamp(std::floor(low), static_cast<double>(*begin), end);
  *begin = static_cast<int>(start);
  *size = static_cast<int>(end - start);
}

// What the pair has to do: cells, seeds, and the windows that hold them.
class Task {
 public:
  Task(const PairInput& input, const PairGeometry& geometry, double growth)
      : input_(input), geometry_(geometry), growth_(growth) {
    MakeSeeds();
  }

  const std::vector<Seed>& Seeds() const { return seeds_; }

  bool IsClosed(size_t cell) const { return !input_.in_full && WasClosed(cell); }
  bool IsCovered(size_t cell) const { return !input_.in_full && WasCovered(cell); }
  bool IsFree(size_t cell) const { return !IsClosed(cell) && !IsCovered(cell); }

  // Cells whose surface was not reconstructed before, in_full or not.
  std::vector<uint8_t> NewCells() const {
    std::vector<uint8_t> is_new(input_.cells.Size(), 1);
    for (size_t cell = 0; cell < is_new.size(); ++cell) {
      is_new[cell] = !WasClosed(cell) && !WasCovered(cell);
    }
    return is_new;
  }

  // The part of picture 1's window that holds free cells, and what new objects in front of covered
  // ones can grow to; `margin` pixels around for the correlation windows.
  RectWindow Window1(int margin) const {
    const CellGrid& cells = input_.cells;
    RectBox box;
    const size_t width = static_cast<size_t>(cells.width);
    const auto free_at = [&](size_t cell) { return IsFree(cell); };
    for (size_t cell = 0; cell < cells.Size(); ++cell) {
      if (!free_at(cell)) continue;
      const bool inner = cell >= width && cell + width < cells.Size() && cell % width > 0 &&
                         cell % width + 1 < width && free_at(cell - 1) && free_at(cell + 1) &&
                         free_at(cell - width) && free_at(cell + width);
      if (inner) continue;  // the box is that of the others
      const auto rect = geometry_.RectFromPixel1(cells.Center(cell));
      if (rect) box.Add(rect->x(), rect->y(), margin + 2 * cells.cell);
    }
    for (const Seed& seed : covered_seeds_) box.Add(seed.x, seed.y, growth_ + margin);
    RectWindow window = WindowOfPicture(geometry_, false);
    Cut(box.x0, box.x1, &window.x0, &window.width);
    Cut(box.y0, box.y1, &window.y0, &window.height);
    return window;
  }

  // The part of picture 2's window that window 1 may match. Disparities beyond the seeds' range, by
  // a tenth and 16 pixels, are not looked for.
  RectWindow Window2(const RectWindow& window1, int margin) const {
    RectWindow window = WindowOfPicture(geometry_, true);
    Cut(window1.x0 - MaxDisparity() - margin, window1.x0 + window1.width - MinDisparity() + margin,
        &window.x0, &window.width);
    Cut(window1.y0, window1.y0 + window1.height, &window.y0, &window.height);
    return window;
  }

  // The blocks of picture 1 that open nodes need, and of picture 2 that these may match.
  void WantBlocks(const Gate& gate, const RectWindow& window1, const RectWindow& window2,
                  int margin, BlockMask* blocks1, BlockMask* blocks2) const {
    const SampleGrid& nodes = gate.Nodes();
    for (int b = 0; b < nodes.height; ++b) {
      for (int a = 0; a < nodes.width; ++a) {
        const int x = a * nodes.step, y = b * nodes.step;
        if (gate.At(x, y) != Gate::kOpen) continue;
        blocks1->Want(x - margin, y - margin, x + nodes.step + margin, y + nodes.step + margin);
      }
    }
    const int reach = static_cast<int>(growth_) + margin;
    for (const Seed& seed : covered_seeds_) {
      const int x = static_cast<int>(seed.x) - window1.x0,
                y = static_cast<int>(seed.y) - window1.y0;
      blocks1->Want(x - reach, y - reach, x + reach, y + reach);
    }
    const int shift = window1.x0 - window2.x0, down = window1.y0 - window2.y0;
    for (int row = 0; row < blocks1->Rows(); ++row) {
      for (int column = 0; column < blocks1->Columns(); ++column) {
        if (!blocks1->Wanted(column, row)) continue;
        const int x = column * BlockMask::kWidth + shift, y = row * BlockMask::kHeight + down;
        blocks2->Want(x - MaxDisparity(), y, x + BlockMask::kWidth - MinDisparity(),
                      y + BlockMask::kHeight);
      }
    }
  }

 private:
  // Before this pair, in_full or not.
  bool WasClosed(size_t cell) const { return !input_.closed.empty() && input_.closed[cell] != 0; }
  bool WasCovered(size_t cell) const {
    return !input_.covered_range.empty() && input_.covered_range[cell] > 0;
  }

  int MinDisparity() const { return static_cast<int>(0.9 * min_disparity_) - 16; }
  int MaxDisparity() const { return static_cast<int>(1.1 * max_disparity_) + 16; }

  // Pixel pairs -> seeds in the rect frame; those off the epipolar line, behind the cameras, in
  // cells that are closed, or at the depth of what covers their cell fall away.
  void MakeSeeds() {
    for (const PixelPair& pair : input_.seeds) {
      const size_t cell = input_.cells.IndexOf(pair.pixel1.x(), pair.pixel1.y());
      if (IsClosed(cell)) continue;
      const auto rect1 = geometry_.RectFromPixel1(pair.pixel1);
      const auto rect2 = geometry_.RectFromPixel2(pair.pixel2);
      if (!rect1 || !rect2 || std::abs(rect1->y() - rect2->y()) > kMaxRowDifference) continue;
      const Seed seed{rect1->x(), rect1->y(), rect1->x() - rect2->x()};
      if (seed.disparity < 1) continue;
      if (IsCovered(cell)) {
        const double covered =
            geometry_.DisparityAtRange(seed.x, seed.y, input_.covered_range[cell]);
        if (!Gate::Admits(static_cast<float>(covered), static_cast<float>(seed.disparity))) {
          continue;
        }
        covered_seeds_.push_back(seed);
      }
      seeds_.push_back(seed);
      min_disparity_ = std::min(min_disparity_, seed.disparity);
      max_disparity_ = std::max(max_disparity_, seed.disparity);
    }
  }

  const PairInput& input_;
  const PairGeometry& geometry_;
  const double growth_;  // how far a seed may spread, pixels
  std::vector<Seed> seeds_, covered_seeds_;
  double min_disparity_ = 1e30, max_disparity_ = 0;
};

// The gate, and the cell of picture 1 that each of its nodes lies in (-1: outside).
struct GatedNodes {
  Gate gate;
  std::vector<int> cell;
};

GatedNodes MakeGate(const PairInput& input, const Task& task, const PairGeometry& geometry,
                    const RectMap& map1, const RectWindow& window, int node_step) {
  GatedNodes gated{Gate(window, node_step, Gate::kClosed), {}};
  const SampleGrid& nodes = gated.gate.Nodes();
  gated.cell.assign(nodes.Size(), -1);
  for (int b = 0; b < nodes.height; ++b) {
    for (int a = 0; a < nodes.width; ++a) {
      const auto source = map1.Source(nodes.PixelX(a), nodes.PixelY(b));
      if (!source) continue;
      const size_t node = nodes.IndexAt(nodes.PixelX(a), nodes.PixelY(b));
      const size_t cell = input.cells.IndexOf(source->x(), source->y());
      gated.cell[node] = static_cast<int>(cell);
      if (task.IsClosed(cell)) continue;
      gated.gate[node] = Gate::kOpen;
      if (task.IsFree(cell)) continue;
      gated.gate[node] = static_cast<float>(
          geometry.DisparityAtRange(nodes.RectX(a), nodes.RectY(b), input.covered_range[cell]));
    }
  }
  return gated;
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
  const double growth =
      options.max_expansion * std::max(input.view1.camera.width, input.view1.camera.height);
  const Task task(input, *geometry, growth);
  if (task.Seeds().size() < kMinSeeds) return Failed("too few seeds in areas that are new");

  const Timer rectification_timer;
  const int step = SampleStep(input.view1.camera, options);
  const int node_step = step > kMaxFineStep ? kMaxNodeStep : kMinNodeStep;
  const int margin = options.window_size / 2 + node_step;
  const RectWindow window1 = task.Window1(margin);
  const RectWindow window2 = task.Window2(window1, margin);
  if (std::min(window1.width, window2.width) < kMinWindow ||
      std::min(window1.height, window2.height) < kMinWindow) {
    return Failed("the pictures do not overlap");
  }
  const RectMap map1(*geometry, false, window1, num_threads);
  const RectMap map2(*geometry, true, window2, num_threads);
  const GatedNodes nodes = MakeGate(input, task, *geometry, map1, window1, node_step);
  BlockMask blocks1(window1), blocks2(window2);
  task.WantBlocks(nodes.gate, window1, window2, margin, &blocks1, &blocks2);
  const RectPicture picture1 = map1.Rectify(input.picture1->luma, blocks1, num_threads);
  const RectPicture picture2 = map2.Rectify(*input.luma2, blocks2, num_threads);
  PairResult result;
  result.rectification_seconds = rectification_timer.WallSeconds();

  const Timer propagation_timer;
  const float min_zncc = static_cast<float>(options.min_zncc);
  const int max_generations =
      std::max(1, static_cast<int>(growth / node_step) - kMaxRefinementSpread);
  PartialDisparity coarse =
      Propagate(picture1, picture2, nodes.gate, task.Seeds(),
                {kGrowthWindow, kGrowthZncc * min_zncc, max_generations}, num_threads);
  RemoveInconsistent(nodes.gate, &coarse);
  result.partial = Refine(picture1, picture2, nodes.gate, coarse,
                          {options.window_size, min_zncc, step}, num_threads);
  RemoveContradictions(nodes.gate, num_threads, &result.partial);
  PartialSurface surface =
      FitSurface(result.partial, std::max(2, kSmoothing / step), kMaxSlope, num_threads);
  RemoveUnsupported(*geometry, &surface);
  result.propagation_seconds = propagation_timer.WallSeconds();

  result.num_seeds = static_cast<int>(task.Seeds().size());
  result.num_failed_seeds = coarse.num_failed_seeds;
  result.cloud = MakePartialCloud(surface, *geometry, map1, *input.picture1, num_threads);
  result.cloud.image_idx1 = input.view1.image_idx;
  result.cloud.image_idx2 = input.view2.image_idx;
  CellTally tally =
      TallyCells(surface, *geometry, nodes.gate.Nodes(), nodes.cell, input.cells, task.NewCells());
  result.filled = std::move(tally.filled);
  result.footprint = std::move(tally.footprint);
  return result;
}

}  // namespace colmap_seapoint
