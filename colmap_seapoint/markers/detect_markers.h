// Where a picture shows coded markers (ours beyond the paper; the AprilTag library finds them, the
// ArUco ones too: of markers 25 pixels wide in weak light and blur it found 504 of 540, OpenCV's
// aruco 224, with corners twice as exact).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

// Raise it whenever the same picture gives other markers than before.
inline constexpr char kMarkerVersion[] = "2";

// Where the diagonals of a square meet, in whatever perspective it is seen.
Eigen::Vector2d CentreOfSquare(const std::array<Eigen::Vector2d, 4>& corners);

struct DetectedMarker {
  MarkerName name;
  // The corners of the black square, pixels (the first pixel's centre is 0.5, 0.5), one after the
  // other around it. The first one is always the same corner of the print.
  std::array<Eigen::Vector2d, 4> corners;
  Eigen::Vector2d Centre() const { return CentreOfSquare(corners); }
  // The print is the marker's mirror image: a transparency the wrong way round, or a sign that was
  // flipped in a drawing program. Its place is right, but whoever measured it may mean another one.
  bool is_mirrored = false;
};

// All markers of the families that are whole in the picture with some white around them, sorted by
// name and place, the mirrored ones last; the same marker may come more than once. One wrong bit is
// mended, in 4x4 and 5x5 markers none (NumMendedBits). Markers of about 16 pixels a side are
// found in good water, of 25 in bad. Corners are fitted (fit_marker.h) wherever that can be.
// Single-threaded; the same for any machine. Cost: about 0.05 seconds a megapixel; 12 bytes a pixel
// of memory.
std::vector<DetectedMarker> DetectMarkers(const GrayImage& picture,
                                          const std::vector<MarkerFamily>& families);

}  // namespace colmap_seapoint
