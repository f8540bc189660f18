// rBRIEF (paper 2.4, after ORB): 256 comparisons of smoothed grey levels around a SeaPoint.
//
// Ours: the pattern is not turned point by point. The orientation of a single point, from its
// intensity centroid, is off by ten degrees and more wherever the water is hazy, and that was what
// lost most matches (measured: half of them on the AUV strips, three of four in turbid water). How
// far one picture is turned against the other is a question to thousands of points together: see
// picture_turn.h. The pattern's symmetry makes the answer cost nothing (see TurnDescriptor).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// Pixels that a SeaPoint needs on every side. Tests beyond the picture's edge read the pixel on it.
inline constexpr int kRBriefBorder = 16;

// Upright descriptors, in the frame of `picture`; points at least kRBriefBorder inside. Also sets
// the points' orientations (intensity centroid in a disc of radius 15) for COLMAP's keypoints.
// What is compared is the smoothed picture less its local mean, so that a lamp that moves with the
// camera does not decide tests. Cost: about 4 CPU ms a megapixel and 1 us a point.
std::vector<Descriptor> DescribeSeaPoints(const GrayImage& picture, std::vector<SeaPoint>* points);

// What `descriptor` becomes when its picture is turned by `turns` steps of kTurnStep (from x
// towards y; any integer).
Descriptor TurnDescriptor(const Descriptor& descriptor, int turns);
std::vector<Descriptor> TurnDescriptors(const std::vector<Descriptor>& descriptors, int turns);

}  // namespace colmap_seapoint
