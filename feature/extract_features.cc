#include "feature/extract_features.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/sift_descriptor.h"
#include "feature/feature_levels.h"

namespace colmap_seapoint {

namespace {

constexpr double kLargePixels = 1.5e6;          // of a picture whose own size is too fine ...
constexpr double kSecondChancePixels = 0.75e6;  // ... and at most so many where levels begin then

// One level of the pyramid (paper 4).
struct Level {
  int width = 0, height = 0;          // pixels
  double scale_x = 1, scale_y = 1;    // from its pixels to the picture's
  SeaPointExtractionOptions options;  // with its share of the target interval
};

// The shares of `count` points by level, finest first: in proportion to the levels' areas (paper 4:
// fewer points at coarser scales). The finest level takes what rounding leaves over.
std::vector<int> Shares(int count, int num_levels) {
  double total = 0;
  for (int l = 0; l < num_levels; ++l) total += std::pow(kLevelScale, -2 * l);
  std::vector<int> shares = {count};
  for (int l = 1; l < num_levels; ++l) {
    shares.push_back(static_cast<int>(count * std::pow(kLevelScale, -2 * l) / total));
    shares[0] -= shares.back();
  }
  return shares;
}

// options.num_levels levels, the first of which is the picture reduced `begin` times.
std::vector<Level> PlanLevels(const GrayImage& picture, const SeaPointExtractionOptions& options,
                              int begin) {
  const std::vector<int> least = Shares(options.min_num_features, options.num_levels);
  const std::vector<int> most = Shares(options.max_num_features, options.num_levels);
  std::vector<Level> levels;
  for (size_t l = 0; l < least.size(); ++l) {
    const double scale = std::pow(kLevelScale, begin + static_cast<int>(l));
    Level level;
    level.width = std::max(1, static_cast<int>(std::lround(picture.width / scale)));
    level.height = std::max(1, static_cast<int>(std::lround(picture.height / scale)));
    level.scale_x = static_cast<double>(picture.width) / level.width;
    level.scale_y = static_cast<double>(picture.height) / level.height;
    level.options = options;
    level.options.min_num_features = std::max(1, least[l]);
    level.options.max_num_features = std::max(1, most[l]);
    levels.push_back(std::move(level));
  }
  return levels;
}

// A picture or mask at a level's size: itself where that is its own size, no copy. An empty mask
// stays empty.
class AtLevel {
 public:
  AtLevel(const GrayImage& image, const Level& level) : image_(image) {
    if (image.Empty() || (image.width == level.width && image.height == level.height)) return;
    resized_ = GrayImage(level.width, level.height);
    const cv::Mat source(image.height, image.width, CV_8U, const_cast<uint8_t*>(image.data.data()));
    cv::Mat target(level.height, level.width, CV_8U, resized_.data.data());
    cv::resize(source, target, target.size(), 0, 0, cv::INTER_AREA);
  }
  const GrayImage& Get() const { return resized_.Empty() ? image_ : resized_; }

 private:
  const GrayImage& image_;
  GrayImage resized_;
};

Features Describe(const GrayImage& picture, std::vector<SeaPoint> points, bool with_sift) {
  Features features;
  features.points = std::move(points);
  features.descriptors = DescribeSeaPoints(picture, &features.points);
  if (with_sift) features.sift_descriptors = DescribeBySift(picture, features.points);
  return features;
}

// Takes the features of a level over into the picture's coordinates.
void Append(Features found, const Level& level, Features* features) {
  for (SeaPoint& point : found.points) {
    point.x = static_cast<float>(point.x * level.scale_x);
    point.y = static_cast<float>(point.y * level.scale_y);
    point.scale = static_cast<float>(std::sqrt(level.scale_x * level.scale_y));
  }
  AppendFeatures(found, features);
}

// How often the picture is reduced before the first level of a second chance.
int SecondChanceBegin(const GrayImage& picture) {
  const double num_pixels = static_cast<double>(picture.width) * picture.height;
  if (num_pixels <= kLargePixels) return 0;
  return static_cast<int>(
      std::ceil(std::log(num_pixels / kSecondChancePixels) / (2 * std::log(kLevelScale))));
}

ExtractedFeatures ExtractLevels(const GrayImage& picture, const GrayImage& mask,
                                const SeaPointExtractionOptions& options,
                                const std::vector<Level>& levels) {
  ExtractedFeatures all;
  for (const Level& level : levels) {
    const AtLevel level_picture(picture, level), level_mask(mask, level);
    const GrayImage& grey = level_picture.Get();
    const int border = kRBriefBorder * DescriptionReduction(grey);
    if (std::min(level.width, level.height) <= 2 * border) break;  // no room for any descriptor

    const Detection detection = DetectSeaPoints(grey, level_mask.Get(), level.options, border);
    Append(Describe(grey, detection.points, options.WantsSift()), level, &all.features);
    all.detection.push_back(detection.summary);
  }
  return all;
}

}  // namespace

ExtractedFeatures ExtractFeatures(const GrayImage& picture, const GrayImage& mask,
                                  const SeaPointExtractionOptions& options) {
  return ExtractLevels(picture, mask, options, PlanLevels(picture, options, 0));
}

Features ExtractSecondChance(const GrayImage& picture, const GrayImage& mask,
                             const SeaPointExtractionOptions& options) {
  SEAPOINT_CHECK(options.num_levels == 1);
  Features features = ExtractFeatures(picture, mask, options).features;
  SeaPointExtractionOptions of_levels = options;
  of_levels.num_levels = kSecondChanceLevels;
  const int begin = SecondChanceBegin(picture);
  std::vector<Level> levels = PlanLevels(picture, of_levels, begin);
  if (begin == 0) levels.erase(levels.begin());  // it is there, with more SeaPoints
  AppendFeatures(ExtractLevels(picture, mask, options, levels).features, &features);
  return features;
}

}  // namespace colmap_seapoint
