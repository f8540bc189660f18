#include "densify/completeness/survey_limits.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "densify/completeness/judge_ground.h"

namespace colmap_seapoint {
namespace {

constexpr double kPartOfSurvey = 1.0 / 3;  // covered, of an island
constexpr double kAsGood = 0.9, kOfMedian = 0.25;
constexpr int kTextureReach = 2;  // both ways, of the textures that are looked at together
constexpr double kFew = 0.002;    // of all

struct Bin {
  double all = 0, covered = 0;  // units^2
  double Share() const { return all > 0 ? covered / all : 0; }
};

// Tiles with expected cells that touch one another, and the areas of their cells.
struct Island {
  std::vector<TileKey> tiles;
  double expected = 0, covered = 0;  // units^2
};

std::vector<Island> IslandsOf(TiledGrid<GroundCell>* cells) {
  std::set<TileKey> open;
  for (const TileKey& key : cells->Keys()) {
    const TiledGrid<GroundCell>::Tile& tile = cells->ExistingTile(key);
    if (std::any_of(tile.begin(), tile.end(), [](const auto& c) { return c.is_expected; })) {
      open.insert(key);
    }
  }
  std::vector<Island> islands;
  while (!open.empty()) {
    Island island{{*open.begin()}, 0, 0};
    open.erase(open.begin());
    for (size_t next = 0; next < island.tiles.size(); ++next) {
      const TileKey key = island.tiles[next];
      for (const GroundCell& cell : cells->ExistingTile(key)) {
        island.expected += cell.is_expected ? cell.area : 0;
        island.covered += cell.is_expected && cell.is_covered ? cell.area : 0;
      }
      for (int k = 0; k < 9; ++k) {
        const TileKey beside{key.x + k % 3 - 1, key.y + k / 3 - 1};
        if (open.erase(beside) > 0) island.tiles.push_back(beside);
      }
    }
    islands.push_back(std::move(island));
  }
  return islands;
}

// What two pictures see from two sides: visit(cell, area that it stands for).
template <typename Visitor>
void ForEachPairCell(const GroundLayer& layer, const Visitor& visit) {
  layer.cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected || !cell.has_pair) return;
    // Of the cells that were covered before their pictures were looked at, these are known of a
    // sample.
    const bool is_of_sample = cell.is_covered && !cell.is_from_afar;
    if (is_of_sample && !IsSampledCell(x, y)) return;
    visit(cell, (is_of_sample ? kSampleCells * kSampleCells : 1) * double{cell.area});
  });
}

using TextureBins = std::array<Bin, 255>;

TextureBins CoverageByTexture(const GroundLayer& top) {
  TextureBins bins;
  ForEachPairCell(top, [&](const GroundCell& cell, double area) {
    if (cell.texture >= bins.size()) return;
    Bin& bin = bins[cell.texture];
    bin.all += area;
    bin.covered += cell.is_covered ? area : 0;
  });
  return bins;
}

Bin Sum(const TextureBins& bins, int from, int to) {
  Bin sum;
  for (int k = std::max(0, from); k < std::min(to, static_cast<int>(bins.size())); ++k) {
    sum.all += bins[static_cast<size_t>(k)].all;
    sum.covered += bins[static_cast<size_t>(k)].covered;
  }
  return sum;
}

// Texture of the median of what is covered.
int MedianCovered(const TextureBins& bins) {
  const double covered = Sum(bins, 0, static_cast<int>(bins.size())).covered;
  double below = 0;
  for (size_t t = 0; t < bins.size(); ++t) {
    below += bins[t].covered;
    if (2 * below > covered) return static_cast<int>(t);
  }
  return 0;
}

}  // namespace

void LeaveOutBackground(double survey_gsd, Ground* ground) {
  for (auto& [key, layer] : ground->layers) {
    layer.cells.ForEach([&](int, int, GroundCell& cell) {
      if (!cell.is_covered && cell.gsd > kFar * survey_gsd) cell.is_expected = false;
    });
  }
}

void LeaveOutIslands(Ground* ground) {
  const auto top = ground->layers.find({Side::kTop, 0});
  if (top == ground->layers.end()) return;
  const std::vector<Island> islands = IslandsOf(&top->second.cells);
  const auto largest =
      std::max_element(islands.begin(), islands.end(),
                       [](const Island& a, const Island& b) { return a.expected < b.expected; });
  for (auto island = islands.begin(); island != islands.end(); ++island) {
    if (island == largest || island->covered >= kPartOfSurvey * island->expected) continue;
    for (const TileKey& key : island->tiles) {
      for (GroundCell& cell : top->second.cells.ExistingTile(key)) {
        if (!cell.is_covered) cell.is_expected = false;
      }
    }
  }
}

double ReliableTexture(const Ground& ground) {
  const auto top = ground.layers.find({Side::kTop, 0});
  if (top == ground.layers.end()) return 0;
  const TextureBins bins = CoverageByTexture(top->second);
  const int num_bins = static_cast<int>(bins.size());
  const double few = kFew * Sum(bins, 0, num_bins).all;
  const auto about = [&](int t) { return Sum(bins, t - kTextureReach, t + kTextureReach + 1); };
  const int median = MedianCovered(bins);
  double best = 0;
  for (int t = 0; t < num_bins; ++t) {
    if (about(t).all > few) best = std::max(best, about(t).Share());
  }
  const auto is_reliable = [&](int t) {
    return about(t).all <= few || about(t).Share() >= kAsGood * best;
  };
  int reliable = 0;
  for (int t = 0; t <= median + kTextureReach; ++t) {
    if (!is_reliable(t)) reliable = t + 1;
  }
  return std::max<double>(reliable, kOfMedian * median);
}

void TellWhatLacksTexture(Ground* ground) {
  const double reliable = ReliableTexture(*ground);
  for (auto& [key, layer] : ground->layers) {
    layer.cells.ForEach([&](int, int, GroundCell& cell) {
      if (cell.cause == GapCause::kViewsDisagree && cell.texture < reliable) {
        cell.cause = GapCause::kNoTexture;
      }
    });
  }
}

}  // namespace colmap_seapoint
