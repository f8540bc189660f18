#include "densify/sequence/completion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "densify/sequence/best_view.h"
#include "densify/sequence/covisibility.h"
#include "densify/sequence/open_surface.h"

namespace colmap_seapoint {

namespace {

constexpr double kMinGain = 0.01;  // share of a picture's cells that makes a pair worth it
// Beyond these a pair measures too little, or sees two surfaces. Within them every cell counts by
// how well it is measured, and by a little at least.
constexpr double kMinParallaxDeg = 2, kMaxParallaxDeg = 60;
constexpr double kLeastQuality = 0.05;

// Cells that nothing covers, and their predicted places.
struct OpenCells {
  std::vector<size_t> cells;
  std::vector<Eigen::Vector3d> places;  // world
};

OpenCells OpenCellsOf(const View& view, const CompletionView& seen) {
  const CellGrid& grid = seen.coverage.grid;
  const Rigid3d world_from_cam = view.cam_from_world.Inverse();
  OpenCells open;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (seen.coverage.range[cell] > 0 || seen.predicted_range[cell] <= 0 ||
        seen.tries[cell] >= kMaxTries) {
      continue;
    }
    const auto place = PointAt(view, world_from_cam, grid, cell, seen.predicted_range[cell]);
    if (!place) continue;
    open.cells.push_back(cell);
    open.places.push_back(*place);
  }
  return open;
}

struct Gain {
  int num_cells = 0;            // that were not tried yet
  double quality = 0;           // sum over them
  std::vector<uint8_t> closed;  // all cells but those that the candidate can measure
};

Gain GainWith(const View& partner, const View& view, const CompletionView& seen,
              const OpenCells& open) {
  const Eigen::Vector3d center1 = view.cam_from_world.OriginInSource();
  const Eigen::Vector3d center2 = partner.cam_from_world.OriginInSource();
  Gain gain;
  gain.closed.assign(seen.coverage.grid.Size(), 1);
  for (size_t i = 0; i < open.cells.size(); ++i) {
    const double parallax = ParallaxDeg(open.places[i], center1, center2);
    if (parallax < kMinParallaxDeg || parallax > kMaxParallaxDeg ||
        !SeesWell(partner, open.places[i])) {
      continue;
    }
    if (!seen.admissible.empty() &&
        RangeUncertainty(view, partner, open.places[i]) > seen.admissible[open.cells[i]]) {
      continue;
    }
    gain.closed[open.cells[i]] = 0;
    if (seen.tries[open.cells[i]] > 0) continue;
    ++gain.num_cells;
    gain.quality += std::max(kLeastQuality, ViewQuality(open.places[i], center1, center2));
  }
  return gain;
}

}  // namespace

CompletionView LookAt(const View& view, const CellGrid& cells,
                      const std::vector<PackedFootprint>& footprints, const GivenUp& given_up) {
  CompletionView seen;
  seen.coverage = ProjectCoverage(footprints, view.camera, view.cam_from_world, cells);
  seen.tries.assign(cells.Size(), 0);
  for (size_t k = 0; k < kMaxTries; ++k) {
    const auto tried = ProjectCoverage(given_up.after[k], view.camera, view.cam_from_world, cells);
    for (size_t cell = 0; cell < cells.Size(); ++cell) {
      if (tried.range[cell] > 0) seen.tries[cell] = static_cast<uint8_t>(k + 1);
    }
  }
  return seen;
}

CompletionTarget SelectCompletionPartner(const View& view, const CompletionView& seen,
                                         const std::vector<CompletionCandidate>& candidates) {
  const OpenCells open = OpenCellsOf(view, seen);
  const double min_cells = kMinGain * static_cast<double>(seen.coverage.grid.Size());
  CompletionTarget best;
  double best_quality = 0;
  for (const CompletionCandidate& candidate : candidates) {
    Gain gain = GainWith(candidate.view, view, seen, open);
    if (gain.num_cells <= min_cells || gain.quality <= best_quality) continue;
    best_quality = gain.quality;
    best.partner = candidate.position;
    best.closed = std::move(gain.closed);
  }
  return best;
}

std::vector<PixelPair> SeedsAlongRim(const View& view, const View& partner,
                                     const CompletionView& seen) {
  const CellGrid& grid = seen.coverage.grid;
  const Rigid3d world_from_cam = view.cam_from_world.Inverse();
  std::vector<PixelPair> seeds;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (seen.coverage.range[cell] > 0 || seen.predicted_range[cell] <= 0) continue;
    bool on_rim = false;
    ForEachNeighbor(grid, cell, [&](size_t to) { on_rim = on_rim || seen.coverage.range[to] > 0; });
    if (!on_rim) continue;
    const auto point = PointAt(view, world_from_cam, grid, cell, seen.predicted_range[cell]);
    if (!point || !SeesWell(partner, *point)) continue;
    seeds.push_back(
        {grid.Center(cell), *partner.camera.ImgFromCam(partner.cam_from_world * *point)});
  }
  return seeds;
}

void NoteFailures(const View& view, const CompletionTarget& target,
                  const std::vector<float>& filled, CompletionView* seen, GivenUp* given_up) {
  const CellGrid& grid = seen->coverage.grid;
  const Rigid3d world_from_cam = view.cam_from_world.Inverse();
  std::array<CloudFootprint, kMaxTries> after;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (target.closed[cell] || (!filled.empty() && filled[cell] >= kMinCoveredCell)) continue;
    const double range = seen->predicted_range[cell];
    const auto point = PointAt(view, world_from_cam, grid, cell, range);
    if (!point || !SeesWell(view, *point)) continue;
    const double size = grid.cell * range / view.camera.MeanFocal();
    after[seen->tries[cell]++].patches.push_back({point->cast<float>(), static_cast<float>(size)});
  }
  for (size_t k = 0; k < kMaxTries; ++k) {
    if (after[k].patches.empty()) continue;
    after[k].UpdateSphere();
    given_up->after[k].emplace_back(after[k]);
  }
}

}  // namespace colmap_seapoint
