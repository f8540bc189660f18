#include "feature/extract_features.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/sift_descriptor.h"

namespace colmap_seapoint {

namespace {

constexpr double kLevelScale = 1.4142135623730951;  // between neighbouring pyramid levels

GrayImage Resize(const GrayImage& image, int width, int height) {
  GrayImage resized(width, height);
  const cv::Mat source(image.height, image.width, CV_8U, const_cast<uint8_t*>(image.data.data()));
  cv::Mat target(height, width, CV_8U, resized.data.data());
  cv::resize(source, target, target.size(), 0, 0, cv::INTER_AREA);
  return resized;
}

// The target interval's share of a level: proportional to the level's area (paper 4: fewer points
// at coarser scales). The finest level takes what rounding leaves over.
int LevelShare(int count, int level, int num_levels) {
  double total = 0;
  for (int l = 0; l < num_levels; ++l) total += std::pow(kLevelScale, -2 * l);
  if (level > 0) return static_cast<int>(count * std::pow(kLevelScale, -2 * level) / total);
  int finest = count;
  for (int l = 1; l < num_levels; ++l) finest -= LevelShare(count, l, num_levels);
  return finest;
}

SeaPointExtractionOptions LevelOptions(const SeaPointExtractionOptions& options, int level) {
  SeaPointExtractionOptions at_level = options;
  at_level.min_num_features =
      std::max(1, LevelShare(options.min_num_features, level, options.num_levels));
  at_level.max_num_features =
      std::max(1, LevelShare(options.max_num_features, level, options.num_levels));
  return at_level;
}

// `found`: of a level, in its coordinates.
void Append(const Features& found, double scale_x, double scale_y, Features* features) {
  for (SeaPoint point : found.points) {
    point.x = static_cast<float>(point.x * scale_x);
    point.y = static_cast<float>(point.y * scale_y);
    point.scale = static_cast<float>(std::sqrt(scale_x * scale_y));
    features->points.push_back(point);
  }
  features->descriptors.insert(features->descriptors.end(), found.descriptors.begin(),
                               found.descriptors.end());
  features->sift_descriptors.insert(features->sift_descriptors.end(),
                                    found.sift_descriptors.begin(), found.sift_descriptors.end());
}

}  // namespace

ExtractedFeatures ExtractFeatures(const GrayImage& picture, const GrayImage& mask,
                                  const SeaPointExtractionOptions& options) {
  ExtractedFeatures result;
  for (int level = 0; level < options.num_levels; ++level) {
    const double scale = std::pow(kLevelScale, level);
    const int width = static_cast<int>(std::lround(picture.width / scale));
    const int height = static_cast<int>(std::lround(picture.height / scale));
    const GrayImage level_picture = level == 0 ? GrayImage() : Resize(picture, width, height);
    const GrayImage level_mask =
        level == 0 || mask.Empty() ? GrayImage() : Resize(mask, width, height);
    const GrayImage& grey = level == 0 ? picture : level_picture;
    const int border = kRBriefBorder * DescriptionReduction(grey);
    if (std::min(width, height) <= 2 * border) break;

    DetectionSummary summary;
    Features found;
    found.points = DetectSeaPoints(grey, level == 0 ? mask : level_mask,
                                   LevelOptions(options, level), border, &summary);
    found.descriptors = DescribeSeaPoints(grey, &found.points);
    if (options.descriptor == "sift") found.sift_descriptors = DescribeBySift(grey, found.points);
    Append(found, static_cast<double>(picture.width) / width,
           static_cast<double>(picture.height) / height, &result.features);
    if (level == 0) result.detection = summary;
  }
  return result;
}

}  // namespace colmap_seapoint
