#include "densify/match/rectify_pair.h"

#include <utility>

#include "densify/match/hidden_samples.h"

namespace colmap_seapoint {

namespace {

// What a mask hides is no place of the picture.
std::vector<int> CellsOfNodes(const SampleGrid& nodes, const RectMap& map1, const CellGrid& cells,
                              const GrayImage& mask) {
  std::vector<int> cell_of_node(nodes.Size(), -1);
  for (int b = 0; b < nodes.height; ++b) {
    for (int a = 0; a < nodes.width; ++a) {
      const int x = nodes.PixelX(a), y = nodes.PixelY(b);
      const auto source = map1.Source(x, y);
      if (!source ||
          IsHidden(&mask, static_cast<double>(source->x()), static_cast<double>(source->y()))) {
        continue;
      }
      cell_of_node[nodes.IndexAt(x, y)] = static_cast<int>(cells.IndexOf(source->x(), source->y()));
    }
  }
  return cell_of_node;
}

// Nodes so near to the epipole that even the nearest place has no parallax there are not matched.
Gate MakeGate(const PairPlan& plan, const std::vector<int>& cell_of_node) {
  Gate gate(plan.window1, plan.node_step, Gate::kClosed);
  const SampleGrid& nodes = gate.Nodes();
  size_t node = 0;
  for (int b = 0; b < nodes.height; ++b) {
    for (int a = 0; a < nodes.width; ++a, ++node) {
      if (cell_of_node[node] < 0) continue;
      const size_t cell = static_cast<size_t>(cell_of_node[node]);
      if (plan.avoided.IsClosed(cell) ||
          plan.geometry.SineOfParallax(nodes.RectX(a), nodes.RectY(b), plan.disparities.max) <
              kMinSineOfParallax) {
        continue;
      }
      if (plan.avoided.IsCovered(cell)) {
        gate.Cover(node,
                   CoveredAt(plan.geometry, plan.avoided, cell, nodes.RectX(a), nodes.RectY(b)));
      } else {
        gate.Open(node);
      }
    }
  }
  return gate;
}

// The blocks of picture 1 around open nodes, and around what new objects in front of covered ones
// can grow to.
BlockMask WantedBlocks1(const PairPlan& plan, const Gate& gate) {
  BlockMask blocks(plan.window1);
  const SampleGrid& nodes = gate.Nodes();
  for (int b = 0; b < nodes.height; ++b) {
    for (int a = 0; a < nodes.width; ++a) {
      const int x = a * nodes.step, y = b * nodes.step;
      if (gate.At(x, y) != Gate::kOpen) continue;
      blocks.Want(x - plan.margin, y - plan.margin, x + nodes.step + plan.margin,
                  y + nodes.step + plan.margin);
    }
  }
  const int reach = static_cast<int>(plan.growth) + plan.margin;
  for (const Seed& seed : plan.covered_seeds) {
    const int x = static_cast<int>(seed.x) - plan.window1.x0;
    const int y = static_cast<int>(seed.y) - plan.window1.y0;
    blocks.Want(x - reach, y - reach, x + reach, y + reach);
  }
  return blocks;
}

// The blocks of picture 2 that those of picture 1 may match.
BlockMask WantedBlocks2(const PairPlan& plan, const BlockMask& blocks1) {
  BlockMask blocks(plan.window2);
  const int shift = plan.window1.x0 - plan.window2.x0, down = plan.window1.y0 - plan.window2.y0;
  for (int row = 0; row < blocks1.Rows(); ++row) {
    for (int column = 0; column < blocks1.Columns(); ++column) {
      if (!blocks1.Wanted(column, row)) continue;
      const int x = column * BlockMask::kWidth + shift, y = row * BlockMask::kHeight + down;
      blocks.Want(x - plan.disparities.max, y, x + BlockMask::kWidth - plan.disparities.min,
                  y + BlockMask::kHeight);
    }
  }
  return blocks;
}

}  // namespace

RectifiedPair RectifyPair(const PairInput& input, const PairPlan& plan, int num_threads) {
  RectMap map1(plan.geometry, false, plan.window1, num_threads);
  const RectMap map2(plan.geometry, true, plan.window2, num_threads);
  const SampleGrid nodes(plan.window1, plan.node_step);
  std::vector<int> cell_of_node =
      CellsOfNodes(nodes, map1, plan.avoided.grid, input.picture1->mask);
  Gate gate = MakeGate(plan, cell_of_node);
  const BlockMask blocks1 = WantedBlocks1(plan, gate);
  const BlockMask blocks2 = WantedBlocks2(plan, blocks1);
  RectPicture picture1 = map1.Rectify(input.picture1->luma, blocks1, num_threads);
  RectPicture picture2 = map2.Rectify(*input.luma2, blocks2, num_threads);
  HideInRect(input.mask2, map2, num_threads, &picture2);
  return {std::move(map1), std::move(gate), std::move(cell_of_node), std::move(picture1),
          std::move(picture2)};
}

}  // namespace colmap_seapoint
