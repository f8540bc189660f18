#include "examples/benchmarks/feature/detectors.h"

#include <cstdio>
#include <functional>
#include <opencv2/features2d.hpp>
#include <utility>

#include "examples/benchmarks/feature/pair_measures.h"
#include "feature/extract_features.h"
#include "feature/match_features.h"
#include "feature/matching/flow_filter.h"
#include "feature/matching/two_view_verification.h"

namespace colmap_seapoint {
namespace {

// OpenCV's defaults first. Beyond the last ones lies rounding.
constexpr double kFastThresholds[] = {20, 14, 10, 7, 5, 3, 2};
constexpr double kContrastThresholds[] = {0.04, 0.028, 0.02, 0.014, 0.01, 0.007, 0.005, 0.0035};

class SeaPointDetector : public FeatureDetector {
 public:
  SeaPointDetector(int min_num_features, int max_num_features) {
    extraction_.min_num_features = min_num_features;
    extraction_.max_num_features = max_num_features;
  }
  std::string Name() const override { return "SeaPoints"; }
  std::string Setting() const override {
    return std::to_string(extraction_.min_num_features) + " to " +
           std::to_string(extraction_.max_num_features);
  }
  DetectedFeatures Extract(const GrayImage& picture) const override {
    return {ExtractFeatures(picture, GrayImage(), extraction_).features, {}};
  }
  FeatureMatches Match(const DetectedFeatures& features1,
                       const DetectedFeatures& features2) const override {
    return MatchSeaPoints(features1.features, features2.features, SeaPointMatchingOptions());
  }
  TwoViewGeometry Verify(const Camera& camera1, const DetectedFeatures& features1,
                         const Camera& camera2, const DetectedFeatures& features2,
                         const FeatureMatches&) const override {
    return MatchFeatures(camera1, features1.features, camera2, features2.features,
                         SeaPointMatchingOptions())
        .geometry;
  }

 private:
  SeaPointExtractionOptions extraction_;
};

class OpenCVDetector : public FeatureDetector {
 public:
  OpenCVDetector(std::string name, std::string setting, cv::Ptr<cv::Feature2D> detector, int norm)
      : name_(std::move(name)),
        setting_(std::move(setting)),
        detector_(std::move(detector)),
        norm_(norm) {}
  std::string Name() const override { return name_; }
  std::string Setting() const override { return setting_; }
  DetectedFeatures Extract(const GrayImage& picture) const override {
    const cv::Mat grey(picture.height, picture.width, CV_8U,
                       const_cast<uint8_t*>(picture.data.data()));
    std::vector<cv::KeyPoint> keypoints;
    DetectedFeatures features;
    detector_->detectAndCompute(grey, cv::noArray(), keypoints, features.opencv_descriptors);
    features.features.points.reserve(keypoints.size());
    for (const cv::KeyPoint& keypoint : keypoints) {
      // OpenCV's pixel centres have whole coordinates.
      features.features.points.push_back({keypoint.pt.x + 0.5f, keypoint.pt.y + 0.5f, 1, 0});
    }
    return features;
  }
  FeatureMatches Match(const DetectedFeatures& features1,
                       const DetectedFeatures& features2) const override {
    if (features1.Points().empty() || features2.Points().empty()) return {};
    std::vector<cv::DMatch> nearest;
    cv::BFMatcher(norm_, /*crossCheck=*/true)
        .match(features1.opencv_descriptors, features2.opencv_descriptors, nearest);
    FeatureMatches matches;
    matches.reserve(nearest.size());
    for (const cv::DMatch& match : nearest) {
      matches.push_back(
          {static_cast<uint32_t>(match.queryIdx), static_cast<uint32_t>(match.trainIdx)});
    }
    return FilterFlow(features1.Points(), features2.Points(), matches, 0, FlowFilterOptions());
  }
  TwoViewGeometry Verify(const Camera& camera1, const DetectedFeatures& features1,
                         const Camera& camera2, const DetectedFeatures& features2,
                         const FeatureMatches& matches) const override {
    return VerifyTwoViews(camera1, features1.Points(), camera2, features2.Points(), matches,
                          TwoViewVerificationOptions());
  }

 private:
  std::string name_, setting_;
  cv::Ptr<cv::Feature2D> detector_;
  int norm_;
};

using Detectors = std::vector<std::unique_ptr<FeatureDetector>>;
using MakeDetector = std::function<std::unique_ptr<FeatureDetector>(double threshold)>;

std::unique_ptr<FeatureDetector> MakeOrb(int num_features, double threshold) {
  const auto fast_threshold = static_cast<int>(threshold);
  return std::make_unique<OpenCVDetector>(
      "ORB", "FAST " + std::to_string(fast_threshold),
      cv::ORB::create(num_features, 1.2f, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, fast_threshold),
      cv::NORM_HAMMING);
}

std::unique_ptr<FeatureDetector> MakeSift(int num_features, double threshold) {
  char setting[32];
  std::snprintf(setting, sizeof(setting), "contrast %g", threshold);
  return std::make_unique<OpenCVDetector>(
      "SIFT", setting, cv::SIFT::create(num_features, 3, threshold), cv::NORM_L2);
}

template <size_t kCount>
std::unique_ptr<FeatureDetector> Adjust(const MakeDetector& make,
                                        const double (&thresholds)[kCount], int min_num_features,
                                        const std::vector<GrayImage>& samples) {
  std::unique_ptr<FeatureDetector> detector;
  for (const double threshold : thresholds) {
    detector = make(threshold);
    std::vector<double> counts;
    for (const GrayImage& sample : samples) {
      counts.push_back(static_cast<double>(detector->Extract(sample).Points().size()));
    }
    if (counts.empty() || Median(counts) >= min_num_features) break;
  }
  return detector;
}

}  // namespace

std::vector<std::unique_ptr<FeatureDetector>> MakeDetectors(int min_num_features,
                                                            int max_num_features,
                                                            const std::vector<GrayImage>& samples) {
  Detectors detectors;
  detectors.push_back(std::make_unique<SeaPointDetector>(min_num_features, max_num_features));
  detectors.push_back(Adjust([&](double threshold) { return MakeOrb(max_num_features, threshold); },
                             kFastThresholds, min_num_features, samples));
  detectors.push_back(
      Adjust([&](double threshold) { return MakeSift(max_num_features, threshold); },
             kContrastThresholds, min_num_features, samples));
  return detectors;
}

}  // namespace colmap_seapoint
