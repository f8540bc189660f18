#include "colmap_seapoint/orthomosaic/sources/seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr int kRounds = 3;
constexpr float kImpossible = 1e6f;
constexpr float kSeamCost = 0.3f;           // of a seam where both pictures look the same
constexpr float kDifferenceCost = 2;        // of one where they differ by a factor of e
constexpr float kUnknownDifference = 0.5f;  // where one of them does not see the other's block

using Costs = std::array<float, kMaxSources>;

// A row or a column of blocks.
struct Line {
  int x, y;    // its first block
  int dx, dy;  // from each to the next
  int length;
};

class SeamChooser {
 public:
  SeamChooser(const BlockRelief& blocks, const Exposure& exposure, SourceBlocks* sources)
      : blocks_(blocks), exposure_(exposure), sources_(*sources) {}

  void ChooseAlong(const Line& line) {
    if (!HasChoice(line)) return;
    std::vector<std::array<uint8_t, kMaxSources>> before(static_cast<size_t>(line.length));
    Costs costs = {};  // of the best way to each source of the last block
    int32_t last = -1;
    for (int i = 0; i < line.length; ++i) {
      const int x = line.x + i * line.dx, y = line.y + i * line.dy;
      const int32_t at = SlotAt(x, y);
      if (at < 0 && last >= 0) GoBack(line, i - 1, costs, before);
      if (at >= 0) {
        costs = Advance(last, at, OwnCosts(x, y, line, at), costs, &before[static_cast<size_t>(i)]);
      }
      last = at;
    }
    if (last >= 0) GoBack(line, line.length - 1, costs, before);
  }

 private:
  // -1 where there is nothing to choose from, too: no seam passes there, and the line ends.
  int32_t SlotAt(int x, int y) const {
    const int32_t at = blocks_.Contains(x, y) ? sources_.slot[blocks_.At(x, y)] : -1;
    return at < 0 || sources_.Of(at)[0].picture == kNoPicture ? -1 : at;
  }

  // Of a line whose blocks are all kept there is none.
  bool HasChoice(const Line& line) const {
    if (sources_.is_kept.empty()) return true;
    for (int i = 0; i < line.length; ++i) {
      const int32_t at = SlotAt(line.x + i * line.dx, line.y + i * line.dy);
      if (at >= 0 && !sources_.IsKept(at)) return true;
    }
    return false;
  }

  // Of a block's sources, with the seams to the neighbours across the line.
  Costs OwnCosts(int x, int y, const Line& line, int32_t at) const {
    Costs costs = {};
    if (sources_.IsKept(at)) {
      costs.fill(kImpossible);
      costs[sources_.choice[static_cast<size_t>(at)]] = 0;
      return costs;
    }
    for (size_t k = 0; k < kMaxSources; ++k) {
      const Source& source = sources_.Of(at)[k];
      costs[k] = source.picture == kNoPicture ? kImpossible : source.cost;
    }
    for (const int side : {-1, 1}) {
      const int32_t other = SlotAt(x + side * line.dy, y + side * line.dx);
      if (other < 0) continue;
      const uint8_t chosen = sources_.choice[static_cast<size_t>(other)];
      for (size_t k = 0; k < kMaxSources; ++k) {
        costs[k] += SeamCost(at, sources_.Of(at)[k], other, sources_.Of(other)[chosen]);
      }
    }
    return costs;
  }

  // `before`: which of the last block's sources is on the best way to each.
  Costs Advance(int32_t last, int32_t at, const Costs& own, const Costs& ways,
                std::array<uint8_t, kMaxSources>* before) const {
    if (last < 0) return own;
    Costs costs = own;
    for (size_t k = 0; k < kMaxSources; ++k) {
      float least = 2 * kImpossible;
      for (uint8_t i = 0; i < kMaxSources; ++i) {
        const float cost = ways[i] + SeamCost(last, sources_.Of(last)[i], at, sources_.Of(at)[k]);
        if (cost >= least) continue;
        least = cost;
        (*before)[k] = i;
      }
      costs[k] += least;
    }
    return costs;
  }

  // Sets the choice of the blocks up to `end` that hang together.
  void GoBack(const Line& line, int end, const Costs& costs,
              const std::vector<std::array<uint8_t, kMaxSources>>& before) {
    auto best = static_cast<uint8_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    for (int i = end; i >= 0; --i) {
      const int32_t at = SlotAt(line.x + i * line.dx, line.y + i * line.dy);
      if (at < 0) return;
      sources_.choice[static_cast<size_t>(at)] = best;
      best = before[static_cast<size_t>(i)][best];
    }
  }

  // Between a source of one block and one of its neighbour.
  float SeamCost(int32_t a, const Source& of_a, int32_t b, const Source& of_b) const {
    if (of_a.picture == of_b.picture || of_a.picture == kNoPicture || of_b.picture == kNoPicture) {
      return 0;
    }
    const float at_a = Difference(of_a, sources_.Find(a, of_b.picture));
    const float at_b = Difference(of_b, sources_.Find(b, of_a.picture));
    return kSeamCost + 0.5f * kDifferenceCost * (at_a + at_b);
  }

  // Of what two pictures show of one block, as a share of its brightness.
  float Difference(const Source& a, const Source* b) const {
    if (!b) return kUnknownDifference;
    float difference = 0, sum = 0.01f;
    for (size_t c = 0; c < 3; ++c) {
      const float light_a = exposure_.Gain(a.picture)[c] * LightOf(a.rgb[c]);
      const float light_b = exposure_.Gain(b->picture)[c] * LightOf(b->rgb[c]);
      difference += std::abs(light_a - light_b);
      sum += 0.5f * (light_a + light_b);
    }
    return difference / sum;
  }

  const BlockRelief& blocks_;
  const Exposure& exposure_;
  SourceBlocks& sources_;
};

}  // namespace

void ChooseSources(const BlockRelief& blocks, const Exposure& exposure, int num_threads,
                   SourceBlocks* sources) {
  for (size_t slot = 0; slot < sources->choice.size(); ++slot) {
    if (!sources->IsKept(static_cast<int32_t>(slot))) sources->choice[slot] = 0;
  }
  SeamChooser chooser(blocks, exposure, sources);
  for (int round = 0; round < kRounds; ++round) {
    for (const int first : {0, 1}) {
      ParallelFor(num_threads, (blocks.height - first + 1) / 2, [&](int64_t i) {
        chooser.ChooseAlong({0, first + 2 * static_cast<int>(i), 1, 0, blocks.width});
      });
    }
    for (const int first : {0, 1}) {
      ParallelFor(num_threads, (blocks.width - first + 1) / 2, [&](int64_t i) {
        chooser.ChooseAlong({first + 2 * static_cast<int>(i), 0, 0, 1, blocks.height});
      });
    }
  }
}

}  // namespace colmap_seapoint
