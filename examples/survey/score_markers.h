// What was found of a demo survey's coded markers, against its truth.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/files/markers_csv.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {

struct MarkerScore {
  size_t num_whole = 0;      // sightings that the pictures show whole, margin included
  size_t num_found = 0;      // of these
  size_t num_cut_found = 0;  // found although a part of the board lies outside or is hidden
  size_t num_false = 0;      // what is no marker there
  double min_pixels = 0, max_pixels = 0;  // sides of the black squares that are shown whole
  double rms_pixels = 0;                  // of the centres that were found
};

MarkerScore ScoreMarkers(const SurveyTruth& truth, const std::vector<MarkerSighting>& sightings);

std::string MarkerScoreText(const MarkerScore& score);

}  // namespace colmap_seapoint
