// What an adjustment leaves open of the ground's bend, said.
#pragma once

#include <string>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/lens/ground_bend.h"

namespace colmap_seapoint {

struct LensDoubt {
  GroundBend bend;          // two standard deviations, or what the forms of lens differ by if more
  std::string trades_with;  // the lens's parameter that the bend goes with; "" = none of them
};

// `adjustment` was asked for CurvatureWeights() in `frame`; forms_curvature: LensChoice::bend.
LensDoubt DoubtOf(const BundleAdjustment& adjustment, const GroundFrame& frame,
                  double forms_curvature);

// "the ground may be bent by 0.3 GSD over 5 times the camera's distance", with how far over the
// whole survey, what it trades places with and what would tell, where it is more than one GSD.
std::string Say(const LensDoubt& doubt);

}  // namespace colmap_seapoint
