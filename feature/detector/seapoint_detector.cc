#include "feature/detector/seapoint_detector.h"

#include <algorithm>
#include <cmath>

#include "feature/detector/harris_measure.h"
#include "feature/detector/light_balance.h"
#include "feature/detector/local_maxima.h"

namespace colmap_seapoint {

namespace {

// Remaps the measures to 0..255 by the extremes of the whole map (paper 2.3); balanced ones, which
// the map does not hold, by the greatest of their own.
std::vector<float> Remap(std::vector<float> measures, const LocalMaxima& found, bool are_balanced) {
  if (measures.empty()) return measures;
  const double highest =
      are_balanced ? *std::max_element(measures.begin(), measures.end()) : found.highest;
  const double scale = 255.0 / (highest - found.lowest);
  for (float& measure : measures) {
    measure = static_cast<float>((static_cast<double>(measure) - found.lowest) * scale);
  }
  return measures;
}

// Ours: the top of the quadratic through the 3 x 3 neighbourhood, at most half a pixel away.
SeaPoint FitSubPixel(const LocalMaximum& maximum) {
  auto at = [&](int dx, int dy) { return static_cast<double>(maximum.around[4 + 3 * dy + dx]); };
  const double gx = 0.5 * (at(1, 0) - at(-1, 0));
  const double gy = 0.5 * (at(0, 1) - at(0, -1));
  const double xx = at(1, 0) - 2 * at(0, 0) + at(-1, 0);
  const double yy = at(0, 1) - 2 * at(0, 0) + at(0, -1);
  const double xy = 0.25 * (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1));
  const double det = xx * yy - xy * xy;
  double dx = 0, dy = 0;
  if (det > 0 && xx < 0) {
    dx = std::clamp(-(yy * gx - xy * gy) / det, -0.5, 0.5);
    dy = std::clamp(-(xx * gy - xy * gx) / det, -0.5, 0.5);
  }
  SeaPoint point;
  point.x = static_cast<float>(maximum.x + 0.5 + dx);
  point.y = static_cast<float>(maximum.y + 0.5 + dy);
  return point;
}

// The local maxima that pass the threshold, strongest first. `measures`: one a maximum.
std::vector<SeaPoint> PointsAbove(const AdaptiveThreshold& threshold, const LocalMaxima& found,
                                  const std::vector<float>& measures) {
  if (threshold.count == 0) return {};
  std::vector<size_t> kept;
  for (size_t i = 0; i < measures.size(); ++i) {
    if (measures[i] >= threshold.threshold) kept.push_back(i);
  }
  std::stable_sort(kept.begin(), kept.end(),
                   [&](size_t a, size_t b) { return measures[a] > measures[b]; });
  std::vector<SeaPoint> points;
  for (const size_t i : kept) points.push_back(FitSubPixel(found.maxima[i]));
  return points;
}

// The radius 0 stands for a tenth of the mean spacing that the wanted number of points has when it
// spreads over the whole picture (ours): 2 pixels at 1.4 megapixels and 3000 points.
int NmsRadius(const GrayImage& picture, const SeaPointExtractionOptions& options) {
  if (options.nms_radius > 0) return options.nms_radius;
  const double area = static_cast<double>(picture.width) * picture.height;
  const double spacing = std::sqrt(area / options.max_num_features);
  return std::clamp(static_cast<int>(std::lround(spacing / 10)), 2, 20);
}

}  // namespace

void SeaPointExtractionOptions::Bind(OptionTable* table) {
  const std::string group = "SeaPointExtraction.";
  table->Add(group + "min_num_features", &min_num_features,
             "target interval, lower end: SeaPoints a picture", "paper 2.3", 1, 1000000);
  table->Add(group + "max_num_features", &max_num_features,
             "target interval, upper end: SeaPoints a picture", "paper 2.3", 1, 1000000);
  table->Add(group + "num_levels", &num_levels,
             "levels of the image pyramid; above 1: scale-invariant SI-SeaPoints", "paper 4", 1, 8);
  table->Add(group + "smoothing_sigma", &smoothing_sigma,
             "Gaussian before the gradients, pixels; 0 = none", "ours", 0, 4);
  table->Add(group + "window_size", &window_size, "box over the gradient products, pixels, odd",
             "ours", 3, 11);
  table->Add(group + "harris_k", &harris_k, "k of det - k trace^2", "ours", 0, 0.25);
  table->Add(group + "nms_radius", &nms_radius,
             "radius of the non-maximum suppression, pixels; 0 = a tenth of the points' spacing",
             "ours", 0, 100);
  table->Add(group + "descriptor", &descriptor,
             "what SeaPoints are matched by; sift: some more matches on hard pairs, slower; "
             "COLMAP's own matchers can use it",
             "paper 2.4, 4", {"rbrief", "sift"});
  table->Add(group + "light_balance", &light_balance,
             "how far local contrast is balanced before the threshold; 0 = not (the paper)", "ours",
             0, 1);
}

std::string SeaPointExtractionOptions::Check() const {
  if (max_num_features < min_num_features) {
    return "SeaPointExtraction.max_num_features is " + std::to_string(max_num_features) +
           ", it must be at least min_num_features (" + std::to_string(min_num_features) + ")";
  }
  if (window_size % 2 == 0) {
    return "SeaPointExtraction.window_size is " + std::to_string(window_size) + ", it must be odd";
  }
  return "";
}

Detection DetectSeaPoints(const GrayImage& picture, const GrayImage& mask,
                          const SeaPointExtractionOptions& options, int border, int num_threads) {
  const HarrisOptions harris = {options.smoothing_sigma, options.window_size, options.harris_k};
  const LocalMaxima found =
      FindLocalMaxima(picture, mask, harris, NmsRadius(picture, options),
                      std::max(border, HarrisBorder(harris) + 1), num_threads);
  const std::vector<float> measures =
      Remap(BalanceLight(found, picture.width, picture.height, options.light_balance), found,
            options.light_balance != 0);
  const AdaptiveThreshold threshold =
      FindAdaptiveThreshold(measures, options.min_num_features, options.max_num_features);
  return {PointsAbove(threshold, found, measures),
          {threshold.status, threshold.threshold, threshold.num_rounds,
           static_cast<int>(measures.size())}};
}

}  // namespace colmap_seapoint
