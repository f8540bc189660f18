#include "densify/completeness/gaps/gap_regions.h"

#include <algorithm>
#include <array>
#include <map>

#include "densify/completeness/surface/tiled_grid.h"

namespace colmap_seapoint {
namespace {

using Cells = std::vector<std::pair<int, int>>;

struct Mark {
  GapCause cause = GapCause::kNone;  // of a cell that is missing
  bool is_open = false, is_core = false;
  int region = -1;
};
using Marks = TiledGrid<Mark>;

// Windows are small: they are walked cell by cell.
constexpr int kSmoothReach = 1;    // cells: majority of 3 x 3 decides what is missing
constexpr double kMissing = 0.55;  // of the cells that are expected there
constexpr int kSliverCells = 4;    // a region that holds no such square is a sliver
constexpr int kCauseReach = 5;     // cells: the commonest cause of 11 x 11

bool IsMissing(const GroundCell& cell) {
  return cell.is_expected && !cell.is_covered && !cell.is_thin;
}

// What most of a cell's surroundings are: holes of single cells in the cloud are no gap, and a
// stray point within a gap closes nothing.
bool IsMissingAround(const GroundLayer& layer, int x, int y) {
  int num_expected = 0, num_missing = 0;
  for (int dy = -kSmoothReach; dy <= kSmoothReach; ++dy) {
    for (int dx = -kSmoothReach; dx <= kSmoothReach; ++dx) {
      const GroundCell* cell = layer.cells.Find(x + dx, y + dy);
      if (cell == nullptr || !cell->is_expected) continue;
      ++num_expected;
      num_missing += IsMissing(*cell) ? 1 : 0;
    }
  }
  return num_missing >= kMissing * num_expected;
}

GapCause CommonestCause(const GroundLayer& layer, int x, int y, int reach, GapCause otherwise) {
  std::array<int, kNumGapCauses> votes = {};
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const GroundCell* cell = layer.cells.Find(x + dx, y + dy);
      if (cell != nullptr && IsMissing(*cell)) ++votes[static_cast<size_t>(cell->cause)];
    }
  }
  votes[static_cast<size_t>(GapCause::kNone)] = 0;
  const auto most = std::max_element(votes.begin(), votes.end());
  return *most == 0 ? otherwise : static_cast<GapCause>(most - votes.begin());
}

// All cells that are missing by their surroundings.
Cells MissingCells(GroundLayer* layer, Marks* marks) {
  Cells missing;
  layer->cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected || !IsMissingAround(*layer, x, y)) return;
    missing.emplace_back(x, y);
    marks->At(x, y).cause = cell.cause == GapCause::kNone ? GapCause::kViewsDisagree : cell.cause;
  });
  return missing;
}

bool AreMissing(const Marks& marks, int x, int y, int size) {
  for (int dy = 0; dy < size; ++dy) {
    for (int dx = 0; dx < size; ++dx) {
      const Mark* mark = marks.Find(x + dx, y + dy);
      if (mark == nullptr || mark->cause == GapCause::kNone) return false;
    }
  }
  return true;
}

// Opening by a square. Returns what stays.
Cells Open(const Cells& missing, int size, Marks* marks) {
  for (const auto& [x, y] : missing) {
    if (!AreMissing(*marks, x, y, size)) continue;
    for (int dy = 0; dy < size; ++dy) {
      for (int dx = 0; dx < size; ++dx) marks->At(x + dx, y + dy).is_open = true;
    }
  }
  Cells open;
  for (const auto& [x, y] : missing) {
    if (marks->At(x, y).is_open) open.emplace_back(x, y);
  }
  return open;
}

// Region by region in the order of `cells`: those of one cause that touch.
std::vector<Cells> Components(const Cells& cells, Marks* marks) {
  std::vector<Cells> components;
  for (const auto& start : cells) {
    Mark& first = marks->At(start.first, start.second);
    if (first.region >= 0) continue;
    const int region = static_cast<int>(components.size());
    Cells component = {start};
    first.region = region;
    for (size_t next = 0; next < component.size(); ++next) {
      const auto [x, y] = component[next];
      for (int k = 0; k < 4; ++k) {
        const int nx = x + (k == 0) - (k == 1), ny = y + (k == 2) - (k == 3);
        Mark* mark = marks->Find(nx, ny);
        if (mark == nullptr || !mark->is_open || mark->region >= 0 || mark->cause != first.cause) {
          continue;
        }
        mark->region = region;
        component.emplace_back(nx, ny);
      }
    }
    std::sort(component.begin(), component.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second < b.second : a.first < b.first;
    });
    components.push_back(std::move(component));
  }
  return components;
}

// Whether a square of `size` cells fits into the component.
bool HoldsSquare(const Cells& cells, int size, const Marks& marks) {
  const int region = marks.Find(cells[0].first, cells[0].second)->region;
  for (const auto& [x, y] : cells) {
    bool fits = true;
    for (int k = 0; k < size * size && fits; ++k) {
      const Mark* mark = marks.Find(x + k % size, y + k / size);
      fits = mark != nullptr && mark->region == region;
    }
    if (fits) return true;
  }
  return false;
}

// The cause of the region that most of a sliver's sides touch; its own where none does.
GapCause NeighbourCause(const Cells& cells, const std::vector<bool>& is_sliver,
                        const std::vector<GapCause>& causes, const Marks& marks) {
  std::array<int, kNumGapCauses> sides = {};
  const int own = marks.Find(cells[0].first, cells[0].second)->region;
  for (const auto& [x, y] : cells) {
    for (int k = 0; k < 4; ++k) {
      const Mark* mark = marks.Find(x + (k == 0) - (k == 1), y + (k == 2) - (k == 3));
      if (mark == nullptr || !mark->is_open || mark->region == own) continue;
      const auto other = static_cast<size_t>(mark->region);
      if (!is_sliver[other]) ++sides[static_cast<size_t>(causes[other])];
    }
  }
  const auto most = std::max_element(sides.begin(), sides.end());
  return *most == 0 ? causes[static_cast<size_t>(own)]
                    : static_cast<GapCause>(most - sides.begin());
}

// Slivers take the cause of the region beside them; then regions are found again.
std::vector<Cells> MergeSlivers(const Cells& open, int size, Marks* marks) {
  const std::vector<Cells> first = Components(open, marks);
  std::vector<bool> is_sliver;
  std::vector<GapCause> causes;
  for (const Cells& cells : first) {
    is_sliver.push_back(!HoldsSquare(cells, size, *marks));
    causes.push_back(marks->Find(cells[0].first, cells[0].second)->cause);
  }
  std::vector<GapCause> merged = causes;
  for (size_t i = 0; i < first.size(); ++i) {
    if (is_sliver[i]) merged[i] = NeighbourCause(first[i], is_sliver, causes, *marks);
  }
  for (const auto& [x, y] : open) {
    Mark& mark = marks->At(x, y);
    mark.cause = merged[static_cast<size_t>(mark.region)];
    mark.region = -1;
  }
  for (const auto& [x, y] : open) marks->At(x, y).region = -1;
  return Components(open, marks);
}

GapRegion MakeRegion(const LayerKey& key, const GroundLayer& layer, const Marks& marks,
                     double cell_side, Cells cells) {
  GapRegion region;
  region.layer = key;
  region.cause = marks.Find(cells[0].first, cells[0].second)->cause;
  for (const auto& [x, y] : cells) region.area += layer.cells.Find(x, y)->area;
  region.rings = TraceCells(cells);
  for (Ring& ring : region.rings) {
    for (Eigen::Vector2d& corner : ring) corner *= cell_side;
  }
  region.cells = std::move(cells);
  return region;
}

void FindInLayer(const LayerKey& key, int min_cells, double min_area, double cell_side,
                 GroundLayer* layer, std::vector<GapRegion>* regions) {
  Marks marks;
  const Cells open = Open(MissingCells(layer, &marks), min_cells, &marks);
  std::vector<GapCause> smooth;
  for (const auto& [x, y] : open) {
    smooth.push_back(CommonestCause(*layer, x, y, kCauseReach, marks.At(x, y).cause));
  }
  for (size_t i = 0; i < open.size(); ++i)
    marks.At(open[i].first, open[i].second).cause = smooth[i];
  for (Cells& cells : MergeSlivers(open, kSliverCells, &marks)) {
    GapRegion region = MakeRegion(key, *layer, marks, cell_side, std::move(cells));
    if (region.area >= min_area) regions->push_back(std::move(region));
  }
}

}  // namespace

std::vector<GapRegion> FindGapRegions(int min_cells, double min_area, Ground* ground) {
  std::vector<GapRegion> regions;
  for (auto& [key, layer] : ground->layers) {
    FindInLayer(key, min_cells, min_area, ground->cell_side, &layer, &regions);
  }
  return regions;
}

}  // namespace colmap_seapoint
