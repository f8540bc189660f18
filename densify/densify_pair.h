// One pair -> one partial local cloud (paper 2.6, Figure 14).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/picture.h"
#include "colmap_seapoint/base/rigid3.h"
#include "densify/cloud/partial_cloud.h"
#include "densify/match/propagation.h"
#include "densify/overlap/coverage.h"
#include "densify/partial_densification_options.h"

namespace colmap_seapoint {

struct View {
  int image_idx = -1;
  Camera camera;
  Rigid3d cam_from_world;
};

// A pixel of picture 1 and the pixel of picture 2 that shows the same place.
struct PixelPair {
  Eigen::Vector2d pixel1, pixel2;
};

struct PairInput {
  View view1, view2;
  const Picture* picture1 = nullptr;
  const GrayImage* luma2 = nullptr;
  std::vector<PixelPair> seeds;
  // Cells of picture 1 that are not to be reconstructed again: closed (paper: the overlap mask), or
  // covered at a known range (ours), where only what differs is. Either may be empty.
  CellGrid cells;
  std::vector<uint8_t> closed;
  std::vector<float> covered_range;
  bool in_full = false;  // all of it is reconstructed nevertheless; the footprint has what is new
};

struct PairResult {
  std::string failure;       // why there is nothing, or empty
  PartialDisparity partial;  // what the cloud was made of, before it was smoothed
  PartialCloud cloud;
  CloudFootprint footprint;
  std::vector<float> filled;  // share of each cell's samples that matched, 0..1
  int num_seeds = 0;          // that were usable: on the epipolar line, in an open cell
  int num_failed_seeds = 0;   // that did not spread
  double rectification_seconds = 0, propagation_seconds = 0;  // wall
};

// Pixels between samples: `options.step`, or about 0.75 million samples a picture.
int SampleStep(const Camera& camera, const PartialDensificationOptions& options);
// The cells at which overlap and coverage of a picture are kept: 4 x 4 samples, 8 pixels at least.
CellGrid CellsOf(const Camera& camera, const PartialDensificationOptions& options);

// Same result for any number of threads.
PairResult DensifyPair(const PairInput& input, const PartialDensificationOptions& options,
                       int num_threads);

}  // namespace colmap_seapoint
