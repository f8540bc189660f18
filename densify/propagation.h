// Densification by propagation (paper 2.6, Figure 12): matches grow from seeds to neighbouring
// samples, generation by generation, until regions collide, match too badly, reach what is already
// reconstructed, or are too far from their seed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "densify/rectification.h"

namespace colmap_seapoint {

// A matched SeaPoint (or a triangulated point of the model) in the rect frame.
struct Seed {
  double x = 0, y = 0;   // rect pixels, in picture 1
  double disparity = 0;  // rect pixels
};

// Samples every `step` pixels of picture 1's rectified window; sample (a, b) lies at window pixel
// (a * step + step / 2, b * step + step / 2).
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
};

// Which samples may be matched. kClosed: never. kOpen: yes. A positive value: something at that
// disparity is reconstructed already, so only what differs clearly from it may be matched.
struct SampleGate {
  static constexpr float kOpen = -1;
  static constexpr float kClosed = -2;
  static bool Admits(float gate, float disparity);
};

struct RectPicture {
  RectWindow window;
  GrayImage gray, valid;  // RectMap::Rectify's
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

// The same result for any number of threads: a generation's candidates are scored against the state
// of the one before, and committed in raster order. Cost: about 4 windows a sample.
PartialDisparity Propagate(const RectPicture& picture1, const RectPicture& picture2,
                           const SampleGrid& grid, const std::vector<float>& gate,
                           const std::vector<Seed>& seeds, const PropagationOptions& options,
                           int num_threads);

// Removes what two views cannot agree on (ours): samples that claim the same place in picture 2 as
// a better one, samples that disagree with their neighbours, and specks.
void RemoveInconsistent(const std::vector<float>& gate, PartialDisparity* partial);

}  // namespace colmap_seapoint
