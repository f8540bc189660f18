// A map of a demo survey against the survey's exact truth.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/orthomosaic/sources/map_pictures.h"
#include "examples/benchmarks/map/memory_map.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {

struct ReliefErrors {  // in GSD, off faces steeper than 60 degrees
  double median = 0, p95 = 0;
};

// Against the surface as seen from above (or across the wall), at every pixel with a height.
ReliefErrors MeasureRelief(const SurveyTruth& truth, const MemoryMap& map);

struct MapCoverage {
  double colored_share = 0;  // of the pixels that hold a point of the cloud on the upper surface
  double unseen_share = 0;   // of the coloured pixels: no two pictures truly see a place within one
};

MapCoverage MeasureCoverage(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                            const MemoryMap& map);

struct MarkErrors {
  int num_marks = 0;
  double median = 0, p95 = 0;  // in pixels of the map
};

// Patches of the map, found in the true colours of the seabed as seen from above.
MarkErrors MeasureMarks(const SurveyTruth& truth, const SurveyOptions& options,
                        const MemoryMap& map);

// Mean CIEDE2000 of the map's colours, as means of 8 x 8 pixels all over it, to the seabed's own.
double MeasureColors(const SurveyTruth& truth, const SurveyOptions& options, const MemoryMap& map);

struct SeamSteps {
  int num_pairs = 0;
  double across = 0;  // median step, per cent of the brightness, between neighbours of two sources
  double inside = 0;  // of the same places in one of the two pictures
};

SeamSteps MeasureSeams(const SurveyTruth& truth, const MapPictureReader& read,
                       const MemoryMap& map);

}  // namespace colmap_seapoint
