#include "colmap_seapoint/markers/detect_markers.h"

#include <apriltag/apriltag.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <deque>
#include <memory>
#include <string>
#include <tuple>

#include "colmap_seapoint/markers/fit_marker.h"
#include "colmap_seapoint/markers/marker_codes.h"

namespace colmap_seapoint {
namespace {

// The library thresholds in tiles; pictures below this have no room for a marker anyway.
constexpr int kMinSide = 16;
// A marker and its mirror image may be read at one place by chance of their bits: it is the marker
// then. In pixels.
constexpr double kSamePlace = 2;

// The library's own form of a family; `mirrored` reads the bits of its mirror images.
class LibraryFamily {
 public:
  LibraryFamily(MarkerFamily name, bool mirrored)
      : name_(name), is_mirrored_(mirrored), codes_(CodesOf(name)), text_(FamilyText(name)) {
    const auto side = static_cast<uint32_t>(codes_.side);
    if (mirrored) {
      for (uint32_t& column : codes_.columns) column = side + 1 - column;
    }
    family_.ncodes = static_cast<uint32_t>(codes_.codes.size());
    family_.codes = codes_.codes.data();
    family_.width_at_border = codes_.side + 2;
    family_.total_width = codes_.side + 4;
    family_.reversed_border = false;
    family_.nbits = side * side;
    family_.bit_x = codes_.columns.data();
    family_.bit_y = codes_.rows.data();
    family_.h = 1;
    family_.name = text_.data();
  }
  LibraryFamily(const LibraryFamily&) = delete;
  LibraryFamily& operator=(const LibraryFamily&) = delete;

  apriltag_family_t* Get() { return &family_; }
  MarkerFamily Name() const { return name_; }
  bool IsMirrored() const { return is_mirrored_; }

 private:
  MarkerFamily name_;
  bool is_mirrored_;
  MarkerCodes codes_;
  std::string text_;
  apriltag_family_t family_{};
};

DetectedMarker ToMarker(const apriltag_detection_t& found, const LibraryFamily& family) {
  DetectedMarker marker;
  marker.name = {family.Name(), found.id};
  marker.is_mirrored = family.IsMirrored();
  for (size_t k = 0; k < 4; ++k) marker.corners[k] = {found.p[k][0], found.p[k][1]};
  return marker;
}

std::vector<DetectedMarker> Run(apriltag_detector_t* detector, std::deque<LibraryFamily>& families,
                                const GrayImage& picture) {
  // The library takes the picture as writable, and does not write into it.
  image_u8_t view = {picture.width, picture.height, picture.width,
                     const_cast<uint8_t*>(picture.data.data())};
  const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(
      apriltag_detector_detect(detector, &view), apriltag_detections_destroy);
  std::vector<DetectedMarker> markers;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    const apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    for (LibraryFamily& family : families) {
      if (family.Get() != detection->family) continue;
      markers.push_back(ToMarker(*detection, family));
    }
  }
  return markers;
}

auto OrderOf(const DetectedMarker& marker) {
  const Eigen::Vector2d& corner = marker.corners[0];
  return std::make_tuple(marker.is_mirrored, marker.name.family, marker.name.id, corner.y(),
                         corner.x());
}

// Sorted, the mirrored ones last: these go where a marker that is not lies at the same place.
void DropFalseMirrors(std::vector<DetectedMarker>* markers) {
  const auto first = std::find_if(markers->begin(), markers->end(),
                                  [](const DetectedMarker& marker) { return marker.is_mirrored; });
  const auto is_false = [&](const DetectedMarker& marker) {
    return std::any_of(markers->begin(), first, [&](const DetectedMarker& other) {
      return (other.Centre() - marker.Centre()).norm() < kSamePlace;
    });
  };
  markers->erase(std::remove_if(first, markers->end(), is_false), markers->end());
}

}  // namespace

Eigen::Vector2d CentreOfSquare(const std::array<Eigen::Vector2d, 4>& corners) {
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  const Eigen::Vector2d first = corners[2] - corners[0], second = corners[3] - corners[1];
  return corners[0] + cross(corners[1] - corners[0], second) / cross(first, second) * first;
}

std::vector<DetectedMarker> DetectMarkers(const GrayImage& picture,
                                          const std::vector<MarkerFamily>& families) {
  if (families.empty() || std::min(picture.width, picture.height) < kMinSide) return {};
  std::deque<LibraryFamily> library;
  const std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector(
      apriltag_detector_create(), apriltag_detector_destroy);
  detector->nthreads = 1;
  detector->quad_decimate = 1;  // small markers are what a survey shows
  detector->refine_edges = true;
  for (const MarkerFamily family : families) {
    for (const bool mirrored : {false, true}) {
      apriltag_detector_add_family_bits(
          detector.get(), library.emplace_back(family, mirrored).Get(), NumMendedBits(family));
    }
  }
  std::vector<DetectedMarker> markers = Run(detector.get(), library, picture);
  std::sort(markers.begin(), markers.end(), [](const DetectedMarker& a, const DetectedMarker& b) {
    return OrderOf(a) < OrderOf(b);
  });
  DropFalseMirrors(&markers);
  for (DetectedMarker& marker : markers) {
    if (const auto corners = FitCorners(picture, marker)) marker.corners = *corners;
  }
  return markers;
}

}  // namespace colmap_seapoint
