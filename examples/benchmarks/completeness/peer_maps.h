// What other tools would call covered, on the cells of the truth: to see what they cover up.
#pragma once

#include <vector>

#include "examples/benchmarks/completeness/gap_truth.h"

namespace colmap_seapoint {

// One a cell of `truth`, row by row: whether the map says that it is covered.
using CoverMap = std::vector<bool>;

// The footprint map, as of drone-tm: what the frame of a picture holds of a level ground at the
// seabed's mean height is covered. Of the pictures that have a pose. Positions alone are asked;
// whether anything came out is not.
CoverMap FootprintMap(const SurveyTruth& survey, const PlantedGaps& gaps, const GapTruth& truth);

// ODM's overlap diagram (stages/odm_report.py; PDAL's writers.gdal): 1400 pixels along the longer
// side of the cloud, each the largest number of views of the points within the diagonal of a pixel.
// Two views and more are covered, which all points of ours have.
CoverMap ViewsMap(const SurveyTruth& survey, const std::vector<Eigen::Vector3f>& points,
                  const GapTruth& truth);

// m^2 on the plan: of the true gaps, what the map says is covered.
double FalselyCovered(const GapTruth& truth, const CoverMap& map);

}  // namespace colmap_seapoint
