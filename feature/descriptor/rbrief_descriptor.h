// rBRIEF (paper 2.4, after ORB): 256 comparisons of smoothed grey levels around a SeaPoint.
//
// Ours: the pattern is not turned point by point. The orientation of a single point, from its
// intensity centroid, is off by ten degrees and more wherever the water is hazy, and that was what
// lost most matches (measured: half of them on the AUV strips, three of four in turbid water). How
// far one picture is turned against the other is a question to thousands of points together: see
// picture_turn.h. The pattern's symmetry makes the answer cost nothing (see TurnDescriptor).
//
// Also ours: half of the tests read the picture, the other half the picture at half size. Fine
// tests keep apart what snow and caustics cover on a larger scale; coarse ones bear relief and
// noise.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// A SeaPoint needs so many pixels of the picture's described size (see DescriptionReduction) on
// every side. Tests beyond the edge read the pixel on it.
inline constexpr int kRBriefBorder = 16;

// Returns 2, 4, ... for a picture of more than 4 megapixels, which is described at 1/2, 1/4, ... of
// its size, else 1: 4 megapixels are enough for matching (measured at 6 and 12 megapixels), and the
// points' places are not touched.
int DescriptionReduction(const GrayImage& picture);

// Returns upright descriptors in the frame of `picture`, one a point; the points must lie at least
// kRBriefBorder times the reduction inside. Also sets the points' orientations, for COLMAP's
// keypoints: the intensity centroid in a disc of radius 15 times the reduction. The tests compare
// the smoothed picture less its local mean (local_contrast.h). Cost: about 5 CPU ms a described
// megapixel and 1 us a point.
std::vector<Descriptor> DescribeSeaPoints(const GrayImage& picture, std::vector<SeaPoint>* points);

// Returns what `descriptor` becomes when its picture is turned by `turns` steps of kTurnStep, from
// x towards y; any integer.
Descriptor TurnDescriptor(const Descriptor& descriptor, int turns);
std::vector<Descriptor> TurnDescriptors(const std::vector<Descriptor>& descriptors, int turns);

}  // namespace colmap_seapoint
