#include "colmap_seapoint/gaps/gap_kml.h"

#include <cstdio>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/gaps/gap_files.h"

namespace colmap_seapoint {
namespace {

std::string Coordinates(const GapPlaces& places, const std::vector<Eigen::Vector3d>& corners,
                        bool is_ring) {
  std::string text = "<coordinates>";
  for (size_t i = 0; i < corners.size() + (is_ring ? 1 : 0); ++i) {
    const Eigen::Vector3d p = places.Write(corners[i % corners.size()]);
    char corner[96];
    std::snprintf(corner, sizeof(corner), "%s%.8f,%.8f,%.3f", i > 0 ? " " : "", p.x(), p.y(),
                  p.z());
    text += corner;
  }
  return text + "</coordinates>";
}

// The outer ring, then the holes in it; rings that lie apart are polygons of their own.
std::string Polygons(const Gap& gap, const GapPlaces& places) {
  std::string text = "<MultiGeometry>";
  bool is_open = false;
  for (size_t i = 0; i < gap.outline.size(); ++i) {
    const bool is_outer = !is_open || SignedArea(gap.region.rings[i]) > 0;
    if (is_outer) text += is_open ? "</Polygon><Polygon>" : "<Polygon>";
    is_open = true;
    const std::string boundary = is_outer ? "outerBoundaryIs" : "innerBoundaryIs";
    text += "<" + boundary + "><LinearRing>" + Coordinates(places, gap.outline[i], true) +
            "</LinearRing></" + boundary + ">";
  }
  return text + (is_open ? "</Polygon>" : "") + "</MultiGeometry>";
}

std::string GapPlacemark(const Gap& gap, const GapPlaces& places) {
  char name[96];
  std::snprintf(name, sizeof(name), "gap %d: %s, %.3g m2", gap.id, GapCauseName(gap.region.cause),
                gap.region.area);
  return "<Placemark><name>" + std::string(name) + "</name>" + Polygons(gap, places) +
         "</Placemark>\n";
}

}  // namespace

std::string GapsKml(const CompletenessResult& result, const GapPlaces& places) {
  SEAPOINT_CHECK(places.IsGeographic());
  std::string kml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><name>gaps</name>\n";
  for (const Gap& gap : result.gaps) kml += GapPlacemark(gap, places);
  const std::vector<Eigen::Vector3d> route = RouteCorners(result);
  if (!route.empty()) {
    kml += "<Placemark><name>route</name><LineString>" + Coordinates(places, route, false) +
           "</LineString></Placemark>\n";
  }
  return kml + "</Document></kml>\n";
}

}  // namespace colmap_seapoint
