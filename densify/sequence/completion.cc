#include "densify/sequence/completion.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>

#include "densify/match/rectification.h"
#include "densify/sequence/covisibility.h"

namespace colmap_seapoint {

namespace {

constexpr double kMinGain = 0.01;  // share of a picture's cells that makes a pair worth it
constexpr double kMinParallaxDeg = 2;
constexpr double kMaxParallaxDeg = 40;
constexpr double kRimMargin = 0.01;  // of the partner's sides: no window fits nearer

template <typename Visit>
void ForEachNeighbor(const CellGrid& grid, size_t cell, const Visit& visit) {
  const size_t width = static_cast<size_t>(grid.width);
  if (cell % width > 0) visit(cell - 1);
  if (cell % width + 1 < width) visit(cell + 1);
  if (cell >= width) visit(cell - width);
  if (cell + width < grid.Size()) visit(cell + width);
}

// The point of the world that a cell's centre shows at a range.
std::optional<Eigen::Vector3d> PointAt(const View& view, const Rigid3d& world_from_cam,
                                       const CellGrid& grid, size_t cell, double range) {
  const auto ray = view.camera.CamFromImg(grid.Center(cell));
  if (!ray) return std::nullopt;
  return world_from_cam * (range * ray->homogeneous().normalized());
}

bool SeesWell(const View& view, const Eigen::Vector3d& point) {
  const auto pixel = view.camera.ImgFromCam(view.cam_from_world * point);
  if (!pixel) return false;
  const double x_margin = kRimMargin * view.camera.width;
  const double y_margin = kRimMargin * view.camera.height;
  return pixel->x() >= x_margin && pixel->y() >= y_margin &&
         pixel->x() <= view.camera.width - x_margin && pixel->y() <= view.camera.height - y_margin;
}

}  // namespace

std::vector<double> PredictRanges(const SparseModel& model, const PosedImage& image,
                                  const View& view, const ViewCoverage& coverage) {
  const CellGrid& grid = coverage.grid;
  std::vector<double> range(coverage.range.begin(), coverage.range.end());
  for (const uint64_t id : image.point3D_ids) {
    if (id == kNoPoint3D) continue;
    const Eigen::Vector3d in_cam = view.cam_from_world * model.points3D.at(id).xyz;
    const auto pixel = view.camera.ImgFromCam(in_cam);
    if (!pixel || !view.camera.InImage(*pixel)) continue;
    double& at = range[grid.IndexOf(pixel->x(), pixel->y())];
    if (at == 0) at = in_cam.norm();
  }
  std::queue<size_t> queue;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (range[cell] > 0) queue.push(cell);
  }
  while (!queue.empty()) {
    const size_t cell = queue.front();
    queue.pop();
    ForEachNeighbor(grid, cell, [&](size_t to) {
      if (range[to] > 0) return;
      range[to] = range[cell];
      queue.push(to);
    });
  }
  return range;
}

CompletionView LookAt(const View& view, const CellGrid& cells,
                      const std::vector<PackedFootprint>& footprints, const GivenUp& given_up) {
  CompletionView seen;
  seen.coverage = ProjectCoverage(footprints, view.camera, view.cam_from_world, cells);
  seen.tries.assign(cells.Size(), 0);
  const auto once = ProjectCoverage(given_up.once, view.camera, view.cam_from_world, cells);
  const auto twice = ProjectCoverage(given_up.twice, view.camera, view.cam_from_world, cells);
  for (size_t cell = 0; cell < cells.Size(); ++cell) {
    seen.tries[cell] = twice.range[cell] > 0 ? 2 : once.range[cell] > 0 ? 1 : 0;
  }
  return seen;
}

CompletionTarget SelectCompletionPartner(const View& view, const CompletionView& seen,
                                         const std::vector<CompletionCandidate>& candidates) {
  const CellGrid& grid = seen.coverage.grid;
  const Rigid3d world_from_cam = view.cam_from_world.Inverse();
  std::vector<size_t> cells;            // uncovered ones
  std::vector<Eigen::Vector3d> points;  // their predicted places, world
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (seen.coverage.range[cell] > 0 || seen.predicted_range[cell] <= 0 || seen.tries[cell] >= 2) {
      continue;
    }
    const auto point = PointAt(view, world_from_cam, grid, cell, seen.predicted_range[cell]);
    if (!point) continue;
    cells.push_back(cell);
    points.push_back(*point);
  }
  CompletionTarget best;
  double best_gain = kMinGain * static_cast<double>(grid.Size());
  const Eigen::Vector3d center1 = view.cam_from_world.OriginInSource();
  std::vector<uint8_t> closed;
  for (const CompletionCandidate& candidate : candidates) {
    if (!MakePairGeometry(view.camera, view.cam_from_world, candidate.view.camera,
                          candidate.view.cam_from_world)) {
      continue;
    }
    const Eigen::Vector3d center2 = candidate.view.cam_from_world.OriginInSource();
    double gain = 0;
    closed.assign(grid.Size(), 1);
    for (size_t i = 0; i < cells.size(); ++i) {
      const double parallax = ParallaxDeg(points[i], center1, center2);
      if (parallax < kMinParallaxDeg || parallax > kMaxParallaxDeg ||
          !SeesWell(candidate.view, points[i])) {
        continue;
      }
      if (seen.tries[cells[i]] == 0) gain += 1;
      closed[cells[i]] = 0;
    }
    if (gain <= best_gain) continue;
    best_gain = gain;
    best.partner = candidate.position;
    best.closed = closed;
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
  CloudFootprint once, twice;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (target.closed[cell] || (!filled.empty() && filled[cell] >= kMinCoveredCell)) continue;
    const double range = seen->predicted_range[cell];
    const auto point = PointAt(view, world_from_cam, grid, cell, range);
    if (!point || !SeesWell(view, *point)) continue;
    const double size = grid.cell * range / view.camera.MeanFocal();
    CloudFootprint& footprint = seen->tries[cell] == 0 ? once : twice;
    footprint.patches.push_back({point->cast<float>(), static_cast<float>(size)});
    ++seen->tries[cell];
  }
  for (auto [footprint, all] :
       {std::pair(&once, &given_up->once), std::pair(&twice, &given_up->twice)}) {
    if (footprint->patches.empty()) continue;
    footprint->UpdateSphere();
    all->emplace_back(*footprint);
  }
}

}  // namespace colmap_seapoint
