// The spine of feature extraction (paper 2.3, 2.4): grey picture -> SeaPoints -> rBRIEF (and
// SIFT, if options.descriptor says so: paper 4).
#pragma once

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/options.h"
#include "feature/detector/seapoint_detector.h"

namespace colmap_seapoint {

// Raise it whenever the same picture and options give other SeaPoints than before: what an earlier
// run stored is then found again.
inline constexpr char kExtractionVersion[] = "3";

struct ExtractedFeatures {
  Features features;
  DetectionSummary detection;  // how the threshold came about; status tells of a flat picture
};

// Same result for every call on the same pixels. Runs on the caller's thread (pictures are spread
// over threads, not bands). Cost: about 10 CPU ms a megapixel, 4 at 12 megapixels; with
// SIFT three to seven times that.
// `mask` (empty, or the size of the picture): no SeaPoint where it is 0.
ExtractedFeatures ExtractFeatures(const GrayImage& picture, const GrayImage& mask,
                                  const SeaPointExtractionOptions& options);

}  // namespace colmap_seapoint
