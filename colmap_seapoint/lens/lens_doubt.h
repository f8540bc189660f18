// What an adjustment leaves open of the ground's bend, said.
#pragma once

#include <string>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/lens/ground_bend.h"

namespace colmap_seapoint {

struct LensDoubt {
  double bend_gsd = 0;      // two standard deviations, or what the forms of lens differ by if more
  std::string trades_with;  // the lens's parameter that the bend goes with; "" = none of them
};

// `adjustment` was asked for CurvatureWeights() in `frame`; forms_curvature: LensChoice::bend.
LensDoubt DoubtOf(const BundleAdjustment& adjustment, const GroundFrame& frame,
                  double forms_curvature);

// "the ground's bend is known to 0.3 GSD over 5 times its distance", or with what it trades places
// and what would tell, where that is more than one GSD.
std::string Say(const LensDoubt& doubt);

}  // namespace colmap_seapoint
