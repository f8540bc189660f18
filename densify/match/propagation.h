// Densification by propagation (paper 2.6, Figure 12): matches grow from seeds to neighbouring
// samples, generation by generation, until regions collide, match too badly, reach what is already
// reconstructed, or are too far from their seed.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "densify/match/rectification.h"

namespace colmap_seapoint {

// A matched SeaPoint (or a triangulated point of the model) in the rect frame.
struct Seed {
  double x = 0, y = 0;   // rect pixels, in picture 1
  double disparity = 0;  // rect pixels
};

// Samples every `step` pixels of picture 1's rectified window; sample (a, b) lies at window pixel
// (a * step + step / 2, b * step + step / 2), the last of a row maybe just beyond the window.
struct SampleGrid {
  RectWindow window;
  int step = 1;
  int width = 0, height = 0;

  SampleGrid() = default;
  SampleGrid(const RectWindow& rect_window, int sample_step);
  size_t Size() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  int PixelX(int a) const { return a * step + step / 2; }
  int PixelY(int b) const { return b * step + step / 2; }
  double RectX(int a) const { return window.x0 + PixelX(a) + 0.5; }
  double RectY(int b) const { return window.y0 + PixelY(b) + 0.5; }
  // The sample whose square holds a window pixel, the nearest for one beyond the window.
  size_t IndexAt(int x, int y) const {
    return static_cast<size_t>(std::min(y / step, height - 1)) * static_cast<size_t>(width) +
           static_cast<size_t>(std::min(x / step, width - 1));
  }
  // The first sample at or behind a window pixel.
  int FirstFrom(int pixel) const { return (pixel - step / 2 + step - 1) / step; }
};

// Propagation works on a coarse grid of samples, the nodes, 4 or 8 pixels apart; Refine fills in
// between.
inline constexpr int kMinNodeStep = 4, kMaxNodeStep = 8;

// Where picture 1 may be matched, kept at nodes. kClosed: not at all. kOpen: yes. A positive value:
// something at that disparity is reconstructed already, so only what differs clearly from it may be
// matched.
class Gate {
 public:
  static constexpr float kOpen = -1;
  static constexpr float kClosed = -2;

  Gate() = default;
  Gate(const RectWindow& window, int node_step, float value)
      : nodes_(window, node_step), value_(nodes_.Size(), value) {}

  const SampleGrid& Nodes() const { return nodes_; }
  float& operator[](size_t node) { return value_[node]; }
  float operator[](size_t node) const { return value_[node]; }
  // Of the node whose square holds a window pixel.
  float At(int x, int y) const { return value_[nodes_.IndexAt(x, y)]; }
  static bool Admits(float gate, float disparity);

 private:
  SampleGrid nodes_;
  std::vector<float> value_;
};

struct PropagationOptions {
  int window_size;  // correlation window, pixels
  float min_zncc;
  int max_generations;  // the limit on expansion, in samples from the seed
};

// What propagation found: one value a sample. `disparity` is 0 where nothing matched.
struct PartialDisparity {
  SampleGrid grid;
  std::vector<float> disparity;
  std::vector<float> score;
  int num_failed_seeds = 0;  // around which hardly anything matched (paper 2.7)
};

// Disparities of the gate's nodes. The same result for any number of threads: a generation's
// candidates are scored against the state of the one before, and committed in raster order. Cost:
// about 12 windows a node.
PartialDisparity Propagate(const RectPicture& picture1, const RectPicture& picture2,
                           const Gate& gate, const std::vector<Seed>& seeds,
                           const PropagationOptions& options, int num_threads);

}  // namespace colmap_seapoint
