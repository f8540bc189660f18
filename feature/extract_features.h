// The spine of feature extraction (paper 2.3, 2.4): grey picture -> SeaPoints -> rBRIEF, and SIFT
// too if options.descriptor asks for it (paper 4).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/options.h"
#include "feature/detector/seapoint_detector.h"

namespace colmap_seapoint {

// Raise it whenever the same picture and options give other SeaPoints than before, together with
// the hashes in tests/feature/extraction_version_test.cc. What an earlier run stored is then found
// again.
inline constexpr char kExtractionVersion[] = "3";

struct ExtractedFeatures {
  Features features;  // level after level, finest first; on each the strongest first
  // How the threshold came about, by level; kFlat tells of a picture without texture. Levels that
  // are too small to describe a SeaPoint on are not there.
  std::vector<DetectionSummary> detection;
};

// Finds and describes the SeaPoints of a grey picture, none where `mask` (empty, or of the
// picture's size) is 0. The same pixels give the same result on every call. Runs on the caller's
// thread: pictures are spread over threads, not bands. Cost: about 10 CPU ms a megapixel, 4 at 12
// megapixels; with SIFT three to seven times that.
ExtractedFeatures ExtractFeatures(const GrayImage& picture, const GrayImage& mask,
                                  const SeaPointExtractionOptions& options);

// Pyramid levels of a second chance.
inline constexpr int kSecondChanceLevels = 5;

// The SeaPoints of ExtractFeatures, and behind them, as many again and more, SI-SeaPoints of
// kSecondChanceLevels levels (ours): for a picture that its own SeaPoints do not tie to others. A
// picture of up to 1.5 megapixels gets the levels that follow its own size. Of a larger one, they
// begin at 0.75 megapixels, since its finest detail (leaves, grass, ripples) is of the kind that
// looks alike everywhere and is gone in the next picture: of a drone's 9 megapixels over a shore 29
// pairs in 153 are verified by SeaPoints of one level, and 68 by what they show at a quarter of the
// size. Needs options.num_levels of 1.
Features ExtractSecondChance(const GrayImage& picture, const GrayImage& mask,
                             const SeaPointExtractionOptions& options);

}  // namespace colmap_seapoint
