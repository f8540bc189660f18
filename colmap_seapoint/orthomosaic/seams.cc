#include "colmap_seapoint/orthomosaic/seams.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr int kRounds = 8;
constexpr float kSeamCost = 0.3f;           // of a seam where both pictures look the same
constexpr float kDifferenceCost = 2;        // of one where they differ by a factor of e
constexpr float kUnknownDifference = 0.5f;  // where one of them does not see the other's block

class SeamChooser {
 public:
  SeamChooser(const BlockRelief& blocks, const Exposure& exposure, SourceBlocks* sources)
      : blocks_(blocks), exposure_(exposure), sources_(*sources) {}

  void ChooseInRow(int y, int colour) {
    for (int x = (y + colour) % 2; x < blocks_.width; x += 2) {
      const int32_t at = sources_.slot[blocks_.At(x, y)];
      if (at >= 0) Choose(x, y, at);
    }
  }

 private:
  void Choose(int x, int y, int32_t at) {
    const Source* sources = sources_.Of(at);
    float least = 0;
    uint8_t best = 0;
    for (uint8_t k = 0; k < kMaxSources && sources[k].picture != kNoPicture; ++k) {
      float cost = sources[k].cost;
      for (const auto& [dx, dy] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (!blocks_.Contains(x + dx, y + dy)) continue;
        const int32_t other = sources_.slot[blocks_.At(x + dx, y + dy)];
        if (other >= 0) cost += SeamCost(at, sources[k], other);
      }
      if (k > 0 && cost >= least) continue;
      least = cost;
      best = k;
    }
    sources_.choice[static_cast<size_t>(at)] = best;
  }

  // Between a source of one block and the chosen one of another.
  float SeamCost(int32_t at, const Source& source, int32_t other) const {
    const Source& theirs = sources_.Of(other)[sources_.choice[static_cast<size_t>(other)]];
    if (theirs.picture == source.picture || theirs.picture == kNoPicture) return 0;
    const float here = Difference(source, FindSource(at, theirs.picture));
    const float there = Difference(theirs, FindSource(other, source.picture));
    return kSeamCost + 0.5f * kDifferenceCost * (here + there);
  }

  const Source* FindSource(int32_t at, uint32_t picture) const {
    const Source* sources = sources_.Of(at);
    for (int k = 0; k < kMaxSources; ++k) {
      if (sources[k].picture == picture) return &sources[k];
    }
    return nullptr;
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
  std::fill(sources->choice.begin(), sources->choice.end(), uint8_t{0});
  SeamChooser chooser(blocks, exposure, sources);
  for (int round = 0; round < 2 * kRounds; ++round) {
    ParallelFor(num_threads, blocks.height,
                [&](int64_t y) { chooser.ChooseInRow(static_cast<int>(y), round % 2); });
  }
}

}  // namespace colmap_seapoint
