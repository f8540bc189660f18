#include "feature/seapoint_detector.h"

#include <algorithm>
#include <cmath>

#include "feature/harris_measure.h"

namespace colmap_seapoint {

namespace {

struct LocalMaximum {
  int x, y;
  float measure;  // remapped to 0..255
};

// Greatest in its (2 radius + 1)^2 window; of equal ones the first in raster order.
bool IsLocalMaximum(const FloatImage& map, int x, int y, int radius) {
  const float value = map.At(x, y);
  const int x_begin = std::max(0, x - radius), x_end = std::min(map.width - 1, x + radius);
  const int y_begin = std::max(0, y - radius), y_end = std::min(map.height - 1, y + radius);
  for (int v = y_begin; v <= y_end; ++v) {
    const float* row = map.Row(v);
    for (int u = x_begin; u <= x_end; ++u) {
      if (row[u] > value) return false;
      if (row[u] == value && (v < y || (v == y && u < x))) return false;
    }
  }
  return true;
}

// Non-maximum suppression of the map of Harris measures; corners only (measure above 0: below it
// are edges, at it there is no texture). Cheap 3 x 3 test first.
std::vector<LocalMaximum> SuppressNonMaxima(const FloatImage& map, const GrayImage& mask,
                                            int radius, int border) {
  std::vector<LocalMaximum> maxima;
  for (int y = border; y < map.height - border; ++y) {
    const float* above = map.Row(y - 1);
    const float* row = map.Row(y);
    const float* below = map.Row(y + 1);
    for (int x = border; x < map.width - border; ++x) {
      const float value = row[x];
      if (!(value > 0) || value < row[x - 1] || value < row[x + 1] || value < above[x] ||
          value < below[x]) {
        continue;
      }
      if (!mask.Empty() && mask.At(x, y) == 0) continue;
      if (IsLocalMaximum(map, x, y, radius)) maxima.push_back({x, y, value});
    }
  }
  return maxima;
}

// Remaps to 0..255 by the extremes of the whole map (paper 2.3).
void Remap(const FloatImage& map, std::vector<LocalMaximum>* maxima) {
  if (maxima->empty()) return;
  const auto [lowest, highest] = std::minmax_element(map.data.begin(), map.data.end());
  const double scale = 255.0 / (static_cast<double>(*highest) - *lowest);
  for (LocalMaximum& maximum : *maxima) {
    maximum.measure = static_cast<float>((static_cast<double>(maximum.measure) - *lowest) * scale);
  }
}

// Ours: the top of the quadratic through the 3 x 3 neighbourhood, at most half a pixel away.
SeaPoint FitSubPixel(const FloatImage& map, int x, int y) {
  auto at = [&](int dx, int dy) { return static_cast<double>(map.At(x + dx, y + dy)); };
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
  point.x = static_cast<float>(x + 0.5 + dx);
  point.y = static_cast<float>(y + 0.5 + dy);
  return point;
}

// 0 = chosen so that the wanted number of points can spread over the whole picture (ours): a
// seventh of their mean spacing, 3 pixels at 1.4 megapixels and 3000 points.
int NmsRadius(const GrayImage& picture, const SeaPointExtractionOptions& options) {
  if (options.nms_radius > 0) return options.nms_radius;
  const double area = static_cast<double>(picture.width) * picture.height;
  const double spacing = std::sqrt(area / options.max_num_features);
  return std::clamp(static_cast<int>(std::lround(spacing / 7)), 2, 20);
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
             "radius of the non-maximum suppression, pixels; 0 = a seventh of the points' spacing",
             "ours", 0, 100);
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

std::vector<SeaPoint> DetectSeaPoints(const GrayImage& picture, const GrayImage& mask,
                                      const SeaPointExtractionOptions& options, int border,
                                      DetectionSummary* summary) {
  const HarrisOptions harris = {options.smoothing_sigma, options.window_size, options.harris_k};
  const FloatImage map = HarrisMeasure(picture, harris);
  border = std::max(border, HarrisBorder(harris) + 1);
  std::vector<LocalMaximum> maxima =
      SuppressNonMaxima(map, mask, NmsRadius(picture, options), border);
  Remap(map, &maxima);

  std::vector<float> measures;
  for (const LocalMaximum& maximum : maxima) measures.push_back(maximum.measure);
  const AdaptiveThreshold threshold =
      FindAdaptiveThreshold(measures, options.min_num_features, options.max_num_features);
  summary->status = threshold.status;
  summary->threshold = threshold.threshold;
  summary->num_rounds = threshold.num_rounds;
  summary->num_local_maxima = static_cast<int>(maxima.size());

  std::vector<SeaPoint> points;
  if (threshold.count == 0) return points;
  maxima.erase(std::remove_if(maxima.begin(), maxima.end(),
                              [&](const LocalMaximum& maximum) {
                                return maximum.measure < threshold.threshold;
                              }),
               maxima.end());
  std::stable_sort(maxima.begin(), maxima.end(), [](const LocalMaximum& a, const LocalMaximum& b) {
    return a.measure > b.measure;
  });
  for (const LocalMaximum& maximum : maxima) {
    points.push_back(FitSubPixel(map, maximum.x, maximum.y));
  }
  return points;
}

}  // namespace colmap_seapoint
