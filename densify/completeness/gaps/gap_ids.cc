#include "densify/completeness/gaps/gap_ids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <tuple>

namespace colmap_seapoint {
namespace {

struct Overlap {
  size_t num_cells, gap, former;
};

size_t CellsWithin(const GapPlace& gap, double cell_side, const FormerGap& former) {
  if (gap.layer < former.layer || former.layer < gap.layer) return 0;
  Eigen::AlignedBox2d box;
  for (const Ring& ring : former.rings) {
    for (const Eigen::Vector2d& corner : ring) box.extend(corner);
  }
  const AskedArea area{former.rings};
  return static_cast<size_t>(
      std::count_if(gap.cells->begin(), gap.cells->end(), [&](const std::pair<int, int>& cell) {
        const Eigen::Vector2d middle((cell.first + 0.5) * cell_side,
                                     (cell.second + 0.5) * cell_side);
        return box.contains(middle) && area.Contains(middle);
      }));
}

}  // namespace

std::vector<int> AssignGapIds(const std::vector<GapPlace>& gaps, double cell_side,
                              const std::vector<FormerGap>& former, int last_id) {
  std::vector<Overlap> overlaps;
  for (size_t g = 0; g < gaps.size(); ++g) {
    for (size_t f = 0; f < former.size(); ++f) {
      const size_t shared = CellsWithin(gaps[g], cell_side, former[f]);
      if (shared > 0) overlaps.push_back({shared, g, f});
    }
  }
  std::sort(overlaps.begin(), overlaps.end(), [](const Overlap& a, const Overlap& b) {
    return std::tie(b.num_cells, a.gap, a.former) < std::tie(a.num_cells, b.gap, b.former);
  });
  std::vector<int> ids(gaps.size(), 0);
  std::set<int> given;
  for (const Overlap& overlap : overlaps) {
    const int id = former[overlap.former].id;
    if (ids[overlap.gap] != 0 || !given.insert(id).second) continue;
    ids[overlap.gap] = id;
  }
  for (const FormerGap& gap : former) last_id = std::max(last_id, gap.id);
  for (int& id : ids) {
    if (id == 0) id = ++last_id;
  }
  return ids;
}

}  // namespace colmap_seapoint
