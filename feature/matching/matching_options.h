// What a user may set of matching (paper 2.4); the ranges stand in the .cc file, where each field
// is bound to its option.
#pragma once

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// Ours; legal ranges are in Bind().
struct HammingMatcherOptions {
  int max_distance = 80;   // of 256 bits
  double max_ratio = 1.0;  // of nearest to second nearest distance; 1 = no test

  void Bind(OptionTable* table);
};

// COLMAP's own defaults are 0.7 and 0.8. Ours are others because the nearest by chance is rarely
// less than 0.45 apart, and a ratio test of 0.85 costs a sixth of the verified matches and more:
// the flow filter sorts out better. Legal ranges are in Bind().
struct SiftMatcherOptions {
  double max_distance = 0.4;  // angle between the descriptors, radians (ours)
  double max_ratio = 1.0;     // of nearest to second nearest angle; 1 = no test (ours)

  void Bind(OptionTable* table);
};

// The paper gives the vote, not its numbers: these are ours. Legal ranges are in Bind().
struct FlowFilterOptions {
  int num_neighbors = 16;             // nearest matches that vote on a match
  int min_votes = 4;                  // that a match needs
  double max_angle_deg = 12;          // between the directions of vectors that vote for each other
  double max_norm_difference = 0.12;  // share of the larger norm
  double min_tolerance = 4;           // vectors this near always vote for each other, pixels
  double max_slip = 1.5;              // from where the flow around it says the match is, pixels ...
  double max_slip_ratio = 2.3;        // ... or times the median deviation there, if that is more

  void Bind(OptionTable* table);
};

// All ours; legal ranges are in Bind().
struct GuidedMatcherOptions {
  bool enabled = true;
  int max_distance = 96;       // Hamming, of 256 bits
  double max_slip = 1.5;       // from where the flow around it says the match is, pixels ...
  double max_slip_ratio = 15;  // ... or times the median deviation there, if that is more
  double max_error = 1.5;      // from the epipolar line, pixels

  void Bind(OptionTable* table);
};

// COLMAP's defaults; legal ranges are in Bind().
struct TwoViewVerificationOptions {
  int min_num_inliers = 15;           // verified matches that a pair needs
  double max_error = 4.0;             // epipolar or transfer error, pixels
  double max_homography_ratio = 0.8;  // inliers of H for those of E or F, from which it is planar

  void Bind(OptionTable* table);
};

struct SeaPointMatchingOptions {
  HammingMatcherOptions hamming;
  SiftMatcherOptions sift;
  FlowFilterOptions flow;
  GuidedMatcherOptions guided;
  TwoViewVerificationOptions verification;

  void Bind(OptionTable* table);
};

}  // namespace colmap_seapoint
