#include "densify/match/propagation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "colmap_seapoint/base/parallel.h"
#include "densify/kernels/zncc.h"

namespace colmap_seapoint {

namespace {

constexpr int kUnmatched = -1;
constexpr float kMinImprovement = 0.02f;  // that a colliding region needs to take a sample over
constexpr int kSeedSearch = 2;            // pixels of disparity around a seed's own
constexpr int kMaxSearch = kMaxNodeStep * 3 / 4;  // a slope of 0.75 from node to node
constexpr int64_t kChunk = 128;                   // nodes a task

struct Candidate {
  int disparity = kUnmatched;
  float score = -1;
};

// Scores windows of picture 1 against windows of picture 2 at integer disparities.
class WindowMatcher {
 public:
  WindowMatcher(const RectPicture& picture1, const RectPicture& picture2, int window_size)
      : picture1_(picture1),
        picture2_(picture2),
        size_(window_size),
        half_(window_size / 2),
        column_shift_(picture1.window.x0 - picture2.window.x0),
        row_shift_(picture1.window.y0 - picture2.window.y0) {}

  // The whole window of picture 1 lies in the picture: its four corners do.
  bool Fits1(int i, int j) const {
    if (!InRaster(picture1_, i, j)) return false;
    const uint8_t* top = picture1_.gray.Row(j - half_) + i;
    const uint8_t* bottom = picture1_.gray.Row(j + half_) + i;
    return top[-half_] && top[half_] && bottom[-half_] && bottom[half_];
  }

  // scores[k]: at disparity first + k, k < count <= zncc::kMaxRun; -1 where the window does not fit
  // in picture 2. The one of picture 1 must fit.
  void ScoreRun(int i, int j, int first, int count, float* scores) const {
    std::fill_n(scores, count, -1.0f);
    const int origin = i + column_shift_,
              j2 = j + row_shift_;  // column in picture 2 at disparity 0
    const int low = std::max({first, 1, origin + half_ + 1 - picture2_.window.width});
    const int high = std::min(first + count - 1, origin - half_);
    if (low > high || !InRaster(picture2_, origin - low, j2)) return;
    std::array<float, zncc::kMaxRun> by_column;
    zncc::ScoreRun(picture1_.gray, i, j, picture2_.gray, origin - high, j2, size_, high - low + 1,
                   by_column.data());
    for (int d = low; d <= high; ++d) scores[d - first] = by_column[static_cast<size_t>(high - d)];
  }

 private:
  bool InRaster(const RectPicture& picture, int i, int j) const {
    return i >= half_ && j >= half_ && i + half_ < picture.window.width &&
           j + half_ < picture.window.height;
  }

  const RectPicture& picture1_;
  const RectPicture& picture2_;
  const int size_, half_, column_shift_, row_shift_;
};

template <typename Visit>
void ForEachNeighbor(const SampleGrid& grid, int node, const Visit& visit) {
  const int a = node % grid.width, b = node / grid.width;
  if (b > 0) visit(node - grid.width);
  if (a > 0) visit(node - 1);
  if (a + 1 < grid.width) visit(node + 1);
  if (b + 1 < grid.height) visit(node + grid.width);
}

class Propagation {
 public:
  Propagation(const RectPicture& picture1, const RectPicture& picture2, const Gate& gate,
              const PropagationOptions& options, int num_threads)
      : matcher_(picture1, picture2, options.window_size),
        grid_(gate.Nodes()),
        gate_(gate),
        options_(options),
        num_threads_(num_threads),
        search_(grid_.step * 3 / 4),
        nodes_(grid_.Size()) {}

  PartialDisparity Run(const std::vector<Seed>& seeds) {
    PlantSeeds(seeds);
    for (int generation = 0; generation < options_.max_generations && !frontier_.empty();
         ++generation) {
      const std::vector<int> targets = CollectTargets(generation);
      const std::vector<Candidate> candidates = ScoreTargets(targets, generation);
      Commit(targets, candidates, generation + 1);
    }
    return Finish();
  }

 private:
  struct Node {
    Candidate held;
    int generation = -1;  // in which it was last matched
    int visited = -1;     // generation that last collected it as a target
  };

  // The first generation: every seed at its nearest sample, best of a few disparities.
  void PlantSeeds(const std::vector<Seed>& seeds) {
    std::vector<int> targets(seeds.size(), -1);
    std::vector<Candidate> candidates(seeds.size());
    ParallelFor(num_threads_, static_cast<int64_t>(seeds.size()), [&](int64_t s) {
      const Seed& seed = seeds[static_cast<size_t>(s)];
      const int a = static_cast<int>(std::floor((seed.x - grid_.window.x0) / grid_.step));
      const int b = static_cast<int>(std::floor((seed.y - grid_.window.y0) / grid_.step));
      if (a < 0 || b < 0 || a >= grid_.width || b >= grid_.height) return;
      const int center = static_cast<int>(std::lround(seed.disparity));
      std::vector<int> disparities;
      for (int d = -kSeedSearch; d <= kSeedSearch; ++d) disparities.push_back(center + d);
      targets[static_cast<size_t>(s)] = b * grid_.width + a;
      candidates[static_cast<size_t>(s)] =
          Best(b * grid_.width + a, disparities.data(), static_cast<int>(disparities.size()));
    });
    seed_nodes_ = targets;
    std::vector<int> planted;
    std::vector<Candidate> planted_candidates;
    for (size_t s = 0; s < seeds.size(); ++s) {
      if (targets[s] < 0) continue;
      planted.push_back(targets[s]);
      planted_candidates.push_back(candidates[s]);
    }
    Commit(planted, planted_candidates, 0);
  }

  const Candidate& HeldBy(int node) const { return nodes_[static_cast<size_t>(node)].held; }

  // Neighbours of the frontier that are free, or that another region holds at another disparity.
  std::vector<int> CollectTargets(int generation) {
    std::vector<int> targets;
    for (const int node : frontier_) {
      const int disparity = HeldBy(node).disparity;
      ForEachNeighbor(grid_, node, [&](int neighbor) {
        Node& target = nodes_[static_cast<size_t>(neighbor)];
        if (target.visited == generation) return;
        if (gate_[static_cast<size_t>(neighbor)] == Gate::kClosed) return;
        const int held = target.held.disparity;
        if (held != kUnmatched && std::abs(held - disparity) <= search_) return;
        target.visited = generation;
        targets.push_back(neighbor);
      });
    }
    return targets;
  }

  std::vector<Candidate> ScoreTargets(const std::vector<int>& targets, int generation) const {
    std::vector<Candidate> candidates(targets.size());
    const int64_t count = static_cast<int64_t>(targets.size());
    ParallelFor(num_threads_, (count + kChunk - 1) / kChunk, [&](int64_t chunk) {
      const int64_t end = std::min(count, (chunk + 1) * kChunk);
      for (int64_t t = chunk * kChunk; t < end; ++t) {
        candidates[static_cast<size_t>(t)] =
            BestFromNeighbors(targets[static_cast<size_t>(t)], generation);
      }
    });
    return candidates;
  }

  Candidate BestFromNeighbors(int target, int generation) const {
    std::array<int, 4 * (2 * kMaxSearch + 1)> disparities;
    int count = 0;
    const int held = HeldBy(target).disparity;
    ForEachNeighbor(grid_, target, [&](int neighbor) {
      const Node& node = nodes_[static_cast<size_t>(neighbor)];
      if (node.generation != generation) return;
      for (int d = node.held.disparity - search_; d <= node.held.disparity + search_; ++d) {
        int* const end = disparities.data() + count;
        if (d == held || std::find(disparities.data(), end, d) != end) continue;
        disparities[static_cast<size_t>(count++)] = d;
      }
    });
    return Best(target, disparities.data(), count);
  }

  // Sorts the disparities.
  Candidate Best(int target, int* disparities, int count) const {
    Candidate best;
    const int i = grid_.PixelX(target % grid_.width), j = grid_.PixelY(target / grid_.width);
    const size_t node = static_cast<size_t>(target);
    if (gate_[node] == Gate::kClosed || !matcher_.Fits1(i, j)) return best;
    std::sort(disparities, disparities + count);
    int first = 0, run = 0;  // disparities scored at once
    std::array<float, zncc::kMaxRun> scores;
    for (int c = 0; c < count; ++c) {
      const int disparity = disparities[c];
      if (c == 0 || disparity >= first + run) {
        first = disparity;
        run = std::min(zncc::kMaxRun, disparities[count - 1] - first + 1);
        matcher_.ScoreRun(i, j, first, run, scores.data());
      }
      if (!gate_.Admits(node, static_cast<float>(disparity))) continue;
      const float score = scores[static_cast<size_t>(disparity - first)];
      if (score > best.score) best = {disparity, score};
    }
    if (best.score < options_.min_zncc) best.disparity = kUnmatched;
    return best;
  }

  // Where regions collide, the better score wins.
  void Commit(const std::vector<int>& targets, const std::vector<Candidate>& candidates,
              int generation) {
    frontier_.clear();
    for (size_t t = 0; t < targets.size(); ++t) {
      const Candidate& candidate = candidates[t];
      Node& node = nodes_[static_cast<size_t>(targets[t])];
      if (candidate.disparity == kUnmatched) continue;
      if (node.held.disparity != kUnmatched &&
          candidate.score < node.held.score + kMinImprovement) {
        continue;
      }
      node.held = candidate;
      if (node.generation != generation) frontier_.push_back(targets[t]);
      node.generation = generation;
    }
  }

  PartialDisparity Finish() const {
    PartialDisparity partial;
    partial.grid = grid_;
    partial.disparity.assign(grid_.Size(), 0);
    partial.score.assign(grid_.Size(), -1);
    partial.num_failed_seeds =
        static_cast<int>(std::count_if(seed_nodes_.begin(), seed_nodes_.end(),
                                       [&](int node) { return node >= 0 && !HasSpread(node); }));
    ParallelFor(num_threads_, grid_.height, [&](int64_t b) {
      for (int a = 0; a < grid_.width; ++a) {
        const size_t node =
            static_cast<size_t>(b) * static_cast<size_t>(grid_.width) + static_cast<size_t>(a);
        if (nodes_[node].held.disparity != kUnmatched) RefineSubPixel(node, &partial);
      }
    });
    return partial;
  }

  // At least half of the 5 x 5 samples around it are matched, by whichever seed.
  bool HasSpread(int node) const {
    const int a = node % grid_.width, b = node / grid_.width;
    int matched = 0, all = 0;
    for (int v = std::max(0, b - 2); v <= std::min(grid_.height - 1, b + 2); ++v) {
      for (int u = std::max(0, a - 2); u <= std::min(grid_.width - 1, a + 2); ++u) {
        const size_t sample =
            static_cast<size_t>(v) * static_cast<size_t>(grid_.width) + static_cast<size_t>(u);
        ++all;
        if (nodes_[sample].held.disparity != kUnmatched) ++matched;
      }
    }
    return 2 * matched >= all;
  }

  // Climbs to the local maximum (at most 2 pixels), then takes the top of the parabola through it
  // and its neighbours; without a maximum the sample stays unmatched.
  void RefineSubPixel(size_t node, PartialDisparity* partial) const {
    const int i = grid_.PixelX(static_cast<int>(node) % grid_.width);
    const int j = grid_.PixelY(static_cast<int>(node) / grid_.width);
    constexpr int kMaxClimb = 2;
    std::array<float, 2 * kMaxClimb + 3> scores;
    const int first = nodes_[node].held.disparity - kMaxClimb - 1;
    matcher_.ScoreRun(i, j, first, static_cast<int>(scores.size()), scores.data());
    size_t at = kMaxClimb + 1;
    for (int climb = 0; climb <= kMaxClimb; ++climb) {
      const float less = scores[at - 1], here = scores[at], more = scores[at + 1];
      if (less <= here && more <= here) {
        if (less <= -1 || more <= -1) return;
        const float curvature = less - 2 * here + more;
        const float offset = curvature < 0 ? 0.5f * (less - more) / curvature : 0.0f;
        partial->disparity[node] = static_cast<float>(first + static_cast<int>(at)) + offset;
        partial->score[node] = here;
        return;
      }
      at = less > more ? at - 1 : at + 1;
    }
  }

  const WindowMatcher matcher_;
  const SampleGrid grid_;
  const Gate& gate_;
  const PropagationOptions options_;
  const int num_threads_;
  const int search_;  // pixels of disparity around a neighbour's
  std::vector<Node> nodes_;
  std::vector<int> frontier_;
  std::vector<int> seed_nodes_;  // a seed's sample, -1 when it lies outside the window
};

}  // namespace

PartialDisparity Propagate(const RectPicture& picture1, const RectPicture& picture2,
                           const Gate& gate, const std::vector<Seed>& seeds,
                           const PropagationOptions& options, int num_threads) {
  return Propagation(picture1, picture2, gate, options, num_threads).Run(seeds);
}

}  // namespace colmap_seapoint
