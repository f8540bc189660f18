// Pages to print: coded markers, with their names in plain text and a ruler that tells whether the
// printer kept the scale.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/pdf/pdf_document.h"
#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

struct MarkerSheetOptions {
  MarkerName first;          // then one number after the other
  int count = 4;             // markers
  double size_mm = 100;      // side of a black square
  double bar_length_mm = 0;  // between the centres of each two, on strips; 0: single markers
};

// "", or what of the options cannot be printed: the whole sentence.
std::string CheckMarkerSheet(const MarkerSheetOptions& options);

// Single markers: as many as fit on an A4 page. Bars: each one on as many pages as its length
// needs, to be cut and glued end to end at the lines; no marker is cut. A marker is placed upright:
// the mirror image of a page is not the marker.
std::vector<PdfPage> MarkerSheet(const MarkerSheetOptions& options);

}  // namespace colmap_seapoint
