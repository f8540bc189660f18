// The bits of coded markers. A marker is a square of (side + 2) x (side + 2) cells: a black border
// one cell wide, within it side x side bits, and around it a white margin of one cell at least.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

// In the order in which the AprilTag library reads bits: a quarter of the square, then the same
// quarter turned by 90 degrees, and so on; the middle bit, if there is one, comes last.
struct MarkerCodes {
  int side = 0;                         // bits
  std::vector<uint64_t> codes;          // by id; the first bit is the highest, white is 1
  std::vector<uint32_t> columns, rows;  // of each bit, 1 to side
};

// Made once, when first asked for. Any number of threads.
const MarkerCodes& CodesOf(MarkerFamily family);

// How many wrong bits of a marker are mended. The smaller squares have too few bits for any: they
// are found by chance in pictures that show none, a 4x4 one of no matter which number in every
// second picture, a 5x5 one in every fiftieth.
int NumMendedBits(MarkerFamily family);

int NumMarkers(MarkerFamily family);

// Cells of the marker's side, border included.
int NumCells(MarkerFamily family);

// Whether a cell of the marker as it is printed is white; (0, 0) is the upper left corner of the
// black border, and what lies outside of the marker is white. The id must exist.
bool IsWhiteCell(const MarkerName& name, int column, int row);

}  // namespace colmap_seapoint
