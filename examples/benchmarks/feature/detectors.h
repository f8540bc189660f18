// The detectors that are compared (paper 3, Table 1), behind one face: SeaPoints, OpenCV's ORB and
// OpenCV's SIFT, each asked for the same number of points and followed by the same flow filter.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

struct DetectedFeatures {
  Features features;           // descriptors: of SeaPoints only
  cv::Mat opencv_descriptors;  // of the others, one row a point

  const std::vector<SeaPoint>& Points() const { return features.points; }
};

class FeatureDetector {
 public:
  virtual ~FeatureDetector() = default;
  virtual std::string Name() const = 0;
  virtual std::string Setting() const = 0;  // what was chosen so that it finds enough points
  // Detection and description; the threads are the detector's own.
  virtual DetectedFeatures Extract(const GrayImage& picture) const = 0;
  // One-to-one nearest neighbours, then FilterFlow with its defaults.
  virtual FeatureMatches Match(const DetectedFeatures& features1,
                               const DetectedFeatures& features2) const = 0;
  // The geometry of those matches; of SeaPoints with what guided matching adds to it.
  virtual TwoViewGeometry Verify(const Camera& camera1, const DetectedFeatures& features1,
                                 const Camera& camera2, const DetectedFeatures& features2,
                                 const FeatureMatches& matches) const = 0;
};

// SeaPoints (the baseline of all ratios), ORB, SIFT. ORB and SIFT are asked for `max_num_features`.
// Their own thresholds (FAST, contrast) start at OpenCV's defaults and are lowered as a user would,
// once for the whole set, until the median sample picture has `min_num_features` (paper 3:
// "adjusted to produce a comparable number"). Without samples the defaults stay.
std::vector<std::unique_ptr<FeatureDetector>> MakeDetectors(int min_num_features,
                                                            int max_num_features,
                                                            const std::vector<GrayImage>& samples);

}  // namespace colmap_seapoint
