#include "colmap_seapoint/markers/marker_codes.h"

#include <apriltag/tag36h11.h>

#include <array>
#include <memory>

#include "aruco_codes.h"
#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

MarkerCodes Tag36h11Codes() {
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag36h11_create(),
                                                                                tag36h11_destroy);
  MarkerCodes codes;
  codes.side = family->width_at_border - 2;
  codes.codes.assign(family->codes, family->codes + family->ncodes);
  codes.columns.assign(family->bit_x, family->bit_x + family->nbits);
  codes.rows.assign(family->bit_y, family->bit_y + family->nbits);
  return codes;
}

// The places of the bits of a square of `side` in the library's order.
void AddPlaces(int side, MarkerCodes* codes) {
  for (int turn = 0; turn < 4; ++turn) {
    for (int row = 1; row <= side / 2; ++row) {
      for (int column = row; column <= side - row; ++column) {
        int x = column, y = row;
        for (int k = 0; k < turn; ++k) {
          const int before = x;
          x = side + 1 - y;
          y = before;
        }
        codes->columns.push_back(static_cast<uint32_t>(x));
        codes->rows.push_back(static_cast<uint32_t>(y));
      }
    }
  }
  if (side % 2 == 0) return;
  codes->columns.push_back(static_cast<uint32_t>(side / 2 + 1));
  codes->rows.push_back(static_cast<uint32_t>(side / 2 + 1));
}

template <size_t N>
MarkerCodes ArucoCodes(int side, const uint64_t (&by_rows)[N]) {
  MarkerCodes codes;
  codes.side = side;
  AddPlaces(side, &codes);
  const auto num_bits = static_cast<uint32_t>(side * side);
  for (const uint64_t bits : by_rows) {
    uint64_t code = 0;
    for (size_t k = 0; k < num_bits; ++k) {
      const uint32_t place =
          (codes.rows[k] - 1) * static_cast<uint32_t>(side) + codes.columns[k] - 1;
      code = code << 1 | (bits >> (num_bits - 1 - place) & 1);
    }
    codes.codes.push_back(code);
  }
  return codes;
}

}  // namespace

const MarkerCodes& CodesOf(MarkerFamily family) {
  static const std::array<MarkerCodes, 4> all = {Tag36h11Codes(), ArucoCodes(4, kAruco4x4Codes),
                                                 ArucoCodes(5, kAruco5x5Codes),
                                                 ArucoCodes(6, kAruco6x6Codes)};
  return all[static_cast<size_t>(family)];
}

int NumMendedBits(MarkerFamily family) {
  return family == MarkerFamily::kAruco4x4 || family == MarkerFamily::kAruco5x5 ? 0 : 1;
}

int NumMarkers(MarkerFamily family) { return static_cast<int>(CodesOf(family).codes.size()); }

int NumCells(MarkerFamily family) { return CodesOf(family).side + 2; }

bool IsWhiteCell(const MarkerName& name, int column, int row) {
  const MarkerCodes& codes = CodesOf(name.family);
  SEAPOINT_CHECK(name.id >= 0 && name.id < NumMarkers(name.family));
  const int last = codes.side + 1;
  if (column < 0 || row < 0 || column > last || row > last) return true;
  const size_t num_bits = codes.columns.size();
  for (size_t k = 0; k < num_bits; ++k) {
    if (static_cast<int>(codes.columns[k]) != column || static_cast<int>(codes.rows[k]) != row) {
      continue;
    }
    return (codes.codes[static_cast<size_t>(name.id)] >> (num_bits - 1 - k) & 1) != 0;
  }
  return false;
}

}  // namespace colmap_seapoint
