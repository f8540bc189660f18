// rBRIEF (paper 2.4, after ORB): 256 comparisons of smoothed grey levels around a SeaPoint, in a
// pattern turned by the orientation of the intensity centroid.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// Pixels that a descriptor needs on every side of its SeaPoint.
inline constexpr int kRBriefBorder = 28;

// Sets the points' orientations (intensity centroid in a disc of radius 15) and returns their
// descriptors. Points lie in the frame of `picture`, at least kRBriefBorder inside.
std::vector<Descriptor> DescribeSeaPoints(const GrayImage& picture, std::vector<SeaPoint>* points);

}  // namespace colmap_seapoint
