// The plain types of matching in the rectified frame "rect" of a pair (rectification.h): windows of
// it, seeds, samples, where samples may be matched, and what they matched.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "densify/kernels/node_step.h"

namespace colmap_seapoint {

// A window of the rect plane: pixel (i, j) of the window is centred at rect (x0 + i + 0.5, ...).
struct RectWindow {
  int x0 = 0, y0 = 0, width = 0, height = 0;
};

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
  SampleGrid(const RectWindow& rect_window, int sample_step)
      : window(rect_window),
        step(sample_step),
        width((rect_window.width + sample_step - 1) / sample_step),
        height((rect_window.height + sample_step - 1) / sample_step) {}
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

// Disparities of what is reconstructed already, from the farthest to the nearest of one surface.
struct CoveredBand {
  float low = 0, high = 0;

  // Whether a disparity differs clearly from all of it.
  bool Excludes(float disparity) const {
    return disparity < low - (4 + 0.04f * low) || disparity > high + (4 + 0.04f * high);
  }
};

// Propagation works on a coarse grid of samples, the nodes, 4 or 8 pixels apart (node_step.h);
// refinement fills in between. The gate says at each node where picture 1 may be matched. kClosed:
// not at all. kOpen: yes. kCovered: only what differs clearly from what is reconstructed there.
class Gate {
 public:
  enum State : uint8_t { kOpen, kClosed, kCovered };

  Gate() = default;
  Gate(const RectWindow& window, int node_step, State state)
      : nodes_(window, node_step), state_(nodes_.Size(), state), band_(nodes_.Size()) {}

  const SampleGrid& Nodes() const { return nodes_; }
  void Open(size_t node) { state_[node] = kOpen; }
  void Close(size_t node) { state_[node] = kClosed; }
  void Cover(size_t node, const CoveredBand& band) {
    state_[node] = kCovered;
    band_[node] = band;
  }
  State operator[](size_t node) const { return state_[node]; }
  // The node whose square holds a window pixel.
  State At(int x, int y) const { return state_[nodes_.IndexAt(x, y)]; }
  // Whether a disparity may be matched there.
  bool Admits(size_t node, float disparity) const {
    return state_[node] == kOpen || (state_[node] == kCovered && band_[node].Excludes(disparity));
  }
  // Whether a disparity is that of what is reconstructed there.
  bool Holds(size_t node, float disparity) const {
    return state_[node] == kCovered && !band_[node].Excludes(disparity);
  }

 private:
  SampleGrid nodes_;
  std::vector<State> state_;
  std::vector<CoveredBand> band_;
};

// What was matched (paper 2.6, Figure 13), one value a sample: of propagation on nodes, of
// refinement on samples.
struct PartialDisparity {
  SampleGrid grid;
  std::vector<float> disparity;  // rect pixels; 0 where nothing matched
  std::vector<float> score;      // correlation, up to 1; -1 where nothing matched
  std::vector<float> deviation;  // of the disparity, rect pixels (tile_kernels.h); samples only
  int num_failed_seeds = 0;      // around which hardly anything matched (paper 2.7)
};

}  // namespace colmap_seapoint
