#include "tests/benchmark/detectors.h"

#include <opencv2/features2d.hpp>
#include <utility>

#include "feature/extract_features.h"
#include "feature/match_features.h"

namespace colmap_seapoint {
namespace {

class SeaPointDetector : public FeatureDetector {
 public:
  SeaPointDetector(int min_num_features, int max_num_features) {
    extraction_.min_num_features = min_num_features;
    extraction_.max_num_features = max_num_features;
  }
  std::string Name() const override { return "SeaPoints"; }
  DetectedFeatures Extract(const GrayImage& picture) const override {
    return {ExtractFeatures(picture, GrayImage(), extraction_).features, {}};
  }
  FeatureMatches Match(const DetectedFeatures& features1,
                       const DetectedFeatures& features2) const override {
    return MatchSeaPoints(features1.features, features2.features, SeaPointMatchingOptions());
  }

 private:
  SeaPointExtractionOptions extraction_;
};

class OpenCVDetector : public FeatureDetector {
 public:
  OpenCVDetector(std::string name, cv::Ptr<cv::Feature2D> detector, int norm)
      : name_(std::move(name)), detector_(std::move(detector)), norm_(norm) {}
  std::string Name() const override { return name_; }
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
    return FilterFlow(features1.Points(), features2.Points(), matches, FlowFilterOptions());
  }

 private:
  std::string name_;
  cv::Ptr<cv::Feature2D> detector_;
  int norm_;
};

}  // namespace

std::vector<std::unique_ptr<FeatureDetector>> MakeDetectors(int min_num_features,
                                                            int max_num_features) {
  std::vector<std::unique_ptr<FeatureDetector>> detectors;
  detectors.push_back(std::make_unique<SeaPointDetector>(min_num_features, max_num_features));
  detectors.push_back(
      std::make_unique<OpenCVDetector>("ORB", cv::ORB::create(max_num_features), cv::NORM_HAMMING));
  detectors.push_back(
      std::make_unique<OpenCVDetector>("SIFT", cv::SIFT::create(max_num_features), cv::NORM_L2));
  return detectors;
}

}  // namespace colmap_seapoint
