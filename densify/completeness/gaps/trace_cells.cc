#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "densify/completeness/gaps/gap_regions.h"

namespace colmap_seapoint {
namespace {

using Corner = std::pair<int, int>;
enum Heading { kEast, kNorth, kWest, kSouth };
constexpr int kDx[4] = {1, 0, -1, 0}, kDy[4] = {0, 1, 0, -1};

// Sides with a cell on their left and none on their right, by the corner where they begin.
using Sides = std::map<Corner, std::set<Heading>>;

Sides BoundaryOf(const std::vector<Corner>& cells) {
  const std::set<Corner> in(cells.begin(), cells.end());
  Sides sides;
  for (const auto& [x, y] : cells) {
    if (in.count({x, y - 1}) == 0) sides[{x, y}].insert(kEast);
    if (in.count({x + 1, y}) == 0) sides[{x + 1, y}].insert(kNorth);
    if (in.count({x, y + 1}) == 0) sides[{x + 1, y + 1}].insert(kWest);
    if (in.count({x - 1, y}) == 0) sides[{x, y + 1}].insert(kSouth);
  }
  return sides;
}

// Takes the ring that begins with the first side left. Where two rings touch at a corner it turns
// left, so that cells which touch by a corner alone stay apart.
Ring TakeRing(Sides* sides) {
  Ring ring;
  const Corner start = sides->begin()->first;
  Corner at = start;
  Heading heading = *sides->begin()->second.begin();
  int last = -1;
  do {
    const auto place = sides->find(at);
    if (last >= 0) {
      for (const int turn : {1, 0, 3}) {
        const auto next = static_cast<Heading>((last + turn) % 4);
        if (place->second.count(next) == 0) continue;
        heading = next;
        break;
      }
    }
    place->second.erase(heading);
    if (place->second.empty()) sides->erase(place);
    if (last != heading) ring.emplace_back(at.first, at.second);
    last = heading;
    at = {at.first + kDx[heading], at.second + kDy[heading]};
  } while (at != start ||
           (sides->count(at) > 0 && sides->at(at).count(static_cast<Heading>((last + 1) % 4)) > 0));
  return ring;
}

}  // namespace

std::vector<Ring> TraceCells(const std::vector<Corner>& cells) {
  Sides sides = BoundaryOf(cells);
  std::vector<Ring> outer, holes;
  while (!sides.empty()) {
    Ring ring = TakeRing(&sides);
    (SignedArea(ring) > 0 ? outer : holes).push_back(std::move(ring));
  }
  std::vector<Ring> rings;
  std::vector<bool> is_taken(holes.size(), false);
  for (const Ring& ring : outer) {
    rings.push_back(ring);
    for (size_t i = 0; i < holes.size(); ++i) {
      // The cell on the left of a hole's side belongs to its outer ring; so does a place just
      // beside the corner.
      const Eigen::Vector2d corner = holes[i][0];
      const Eigen::Vector2d along = (holes[i][1] - corner).normalized();
      const Eigen::Vector2d inside =
          corner + 0.5 * along + 0.5 * Eigen::Vector2d(-along.y(), along.x());
      if (is_taken[i] || !AskedArea{{ring}}.Contains(inside)) continue;
      is_taken[i] = true;
      rings.push_back(holes[i]);
    }
  }
  return rings;
}

}  // namespace colmap_seapoint
