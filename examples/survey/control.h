// What a diver and a navigation log would bring home from a demo survey: a scale bar that is marked
// in the pictures, and noisy positions of the cameras. All noise follows from the seed.
#pragma once

#include <string>

#include "examples/survey/survey.h"

namespace colmap_seapoint {

struct ControlOptions {
  int seed = 1;
  double bar_length = 1;         // metres between its two targets on the map, about
  double pixel_noise = 0.3;      // standard deviation of each mark, pixels
  double position_noise = 0.05;  // standard deviation of each axis, metres
  double outlier_share = 0.1;    // of the positions
  double outlier_size = 3;       // metres, in a random direction
};

// "" or the whole sentence: option, value, rule.
std::string CheckControlOptions(const ControlOptions& options);

// The three tables in the form that model_scaler reads.
struct ControlTables {
  std::string bars;       // one bar, with its exact length
  std::string targets;    // its two ends, in every picture that sees them
  std::string positions;  // of all pictures, in the survey's own frame
};

// The bar lies on the seabed below the middle of the track. Throws Error when two pictures do not
// see both of its ends.
ControlTables MakeControl(const SurveyTruth& truth, const ControlOptions& options);

}  // namespace colmap_seapoint
