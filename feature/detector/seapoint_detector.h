// The SeaPoint detector (paper 2.3, Figure 4): Harris measure of every pixel, remapped to 0..255 by
// the map's own extremes; non-maximum suppression in a radius; adaptive threshold from the
// cumulative histogram; (ours) measures balanced against uneven light, a quadratic sub-pixel fit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/options.h"
#include "feature/detector/adaptive_threshold.h"

namespace colmap_seapoint {

// Legal ranges are in Bind().
struct SeaPointExtractionOptions {
  int min_num_features = 2500;  // target interval, SeaPoints a picture (paper 2.3)
  int max_num_features = 3000;
  int num_levels = 1;                 // of the pyramid; above 1: SI-SeaPoints (paper 4)
  double smoothing_sigma = 1.5;       // Gaussian before the gradients, pixels; 0 = none (ours)
  int window_size = 7;                // box over the gradient products, pixels, odd (ours)
  double harris_k = 0.04;             // of det - k trace^2 (ours)
  int nms_radius = 0;                 // pixels; 0 = a tenth of the points' spacing (ours)
  std::string descriptor = "rbrief";  // or "sift" beside it (paper 2.4, 4)
  double light_balance = 0.5;         // 0 = none (the paper) .. 1, see light_balance.h (ours)

  void Bind(OptionTable* table);
  // Rules between options: "" or the whole sentence. Ranges are the table's.
  std::string Check() const;
  bool WantsSift() const { return descriptor == "sift"; }
};

struct DetectionSummary {
  ThresholdStatus status = ThresholdStatus::kFlat;
  double threshold = 0;      // on the 0..255 map
  int num_rounds = 0;        // histograms explored
  int num_local_maxima = 0;  // candidates after non-maximum suppression
};

struct Detection {
  std::vector<SeaPoint> points;  // strongest first, ties in raster order
  DetectionSummary summary;
};

// Finds the SeaPoints of one pyramid level, in the coordinates of `picture` (scale 1, orientation
// 0). There is none nearer to the edge than `border` pixels, and none where `mask` (empty, or of
// the picture's size) is 0. num_threads (-1: all cores) share the picture in bands of rows; the
// points are the same for any number. About 3 ms of CPU a megapixel with AVX2.
Detection DetectSeaPoints(const GrayImage& picture, const GrayImage& mask,
                          const SeaPointExtractionOptions& options, int border,
                          int num_threads = 1);

}  // namespace colmap_seapoint
