#include "densify/sequence/best_view.h"

#include <algorithm>
#include <limits>

#include "densify/sequence/open_surface.h"

namespace colmap_seapoint {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Chords between unit rays: of 2 degrees, below which they measure nothing, and of 11.5 degrees,
// above which what a pair gains in depth it loses in likeness.
constexpr double kMinChord = 0.035, kFullChord = 0.2;
constexpr double kAdmitted = 1.5;  // times the least uncertainty
constexpr int kBlock = 4;          // cells that are looked up at once, across and down

// A place as a view sees it.
struct Sight {
  Eigen::Vector3d ray;  // unit, world
  double gsd;           // model units a pixel
};

// Does not outlive its view.
class Viewer {
 public:
  explicit Viewer(const View& view)
      : view_(&view),
        center_(view.cam_from_world.OriginInSource()),
        focal_(view.camera.MeanFocal()) {}

  bool Sees(const Eigen::Vector3d& place) const { return SeesWell(*view_, place); }
  Sight At(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d ray = place - center_;
    const double range = ray.norm();
    return {ray / range, range / focal_};
  }

 private:
  const View* view_;
  Eigen::Vector3d center_;
  double focal_;
};

double UncertaintyOf(const Sight& sight1, const Sight& sight2) {
  const double chord = (sight1.ray - sight2.ray).norm();
  if (!(chord >= kMinChord)) return kInfinite;
  return std::max(sight1.gsd, sight2.gsd) / std::min(chord, kFullChord);
}

double LeastUncertainty(const std::vector<Viewer>& viewers, const Eigen::Vector3d& place) {
  double least = kInfinite;
  std::vector<Sight> sights;
  for (const Viewer& viewer : viewers) {
    if (!viewer.Sees(place)) continue;
    const Sight sight = viewer.At(place);
    for (const Sight& other : sights) least = std::min(least, UncertaintyOf(sight, other));
    sights.push_back(sight);
  }
  return least;
}

// Looked up once for blocks of cells: calls visit with the place that the middle of a block shows
// and the indices of its cells. Blocks whose range is not predicted are left out.
template <typename Visit>
void ForEachBlock(const View& view, const CellGrid& grid,
                  const std::vector<double>& predicted_range, const Visit& visit) {
  const Rigid3d world_from_cam = view.cam_from_world.Inverse();
  const auto index_of = [&](int a, int b) {
    return static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
  };
  std::vector<size_t> cells;
  for (int b0 = 0; b0 < grid.height; b0 += kBlock) {
    for (int a0 = 0; a0 < grid.width; a0 += kBlock) {
      const int b1 = std::min(grid.height, b0 + kBlock), a1 = std::min(grid.width, a0 + kBlock);
      const size_t middle = index_of((a0 + a1) / 2, (b0 + b1) / 2);
      if (predicted_range[middle] <= 0) continue;
      const auto place = PointAt(view, world_from_cam, grid, middle, predicted_range[middle]);
      if (!place) continue;
      cells.clear();
      for (int b = b0; b < b1; ++b) {
        for (int a = a0; a < a1; ++a) cells.push_back(index_of(a, b));
      }
      visit(*place, cells);
    }
  }
}

}  // namespace

double RangeUncertainty(const View& view1, const View& view2, const Eigen::Vector3d& place) {
  const Viewer viewer1(view1), viewer2(view2);
  if (!viewer1.Sees(place) || !viewer2.Sees(place)) return kInfinite;
  return UncertaintyOf(viewer1.At(place), viewer2.At(place));
}

std::vector<double> AdmissibleUncertainty(const View& view, const std::vector<View>& others,
                                          const CellGrid& grid,
                                          const std::vector<double>& predicted_range) {
  std::vector<Viewer> viewers(1, Viewer(view));
  for (const View& other : others) viewers.emplace_back(other);
  std::vector<double> admissible(grid.Size(), kInfinite);
  ForEachBlock(view, grid, predicted_range,
               [&](const Eigen::Vector3d& place, const std::vector<size_t>& cells) {
                 const double uncertainty = kAdmitted * LeastUncertainty(viewers, place);
                 for (const size_t cell : cells) admissible[cell] = uncertainty;
               });
  return admissible;
}

void LeaveToBetterPairs(const View& view, const View& partner,
                        const std::vector<double>& predicted_range,
                        const std::vector<double>& admissible, KnownCells* known) {
  known->closed.resize(known->grid.Size(), 0);
  ForEachBlock(view, known->grid, predicted_range,
               [&](const Eigen::Vector3d& place, const std::vector<size_t>& cells) {
                 // Where the pair measures nothing, at the rims, there is nothing to be left.
                 const double uncertainty = RangeUncertainty(view, partner, place);
                 if (uncertainty == kInfinite || uncertainty <= admissible[cells[0]]) return;
                 for (const size_t cell : cells) known->closed[cell] = 1;
               });
}

}  // namespace colmap_seapoint
