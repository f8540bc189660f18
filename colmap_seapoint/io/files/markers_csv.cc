#include "colmap_seapoint/io/files/markers_csv.h"

#include <cstdio>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/csv_table.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNumFields = 13;
constexpr char kRemedy[] = "make the table anew with marker_finder";

std::string Row(const MarkerSighting& sighting) {
  std::string row = CsvField(sighting.marker) + "," + CsvField(sighting.image) + "," +
                    std::to_string(sighting.width) + "," + std::to_string(sighting.height);
  for (const Eigen::Vector2d& corner : sighting.corners) {
    char text[64];
    std::snprintf(text, sizeof(text), ",%.3f,%.3f", corner.x(), corner.y());
    row += text;
  }
  return row + (sighting.is_mirrored ? ",1\n" : ",0\n");
}

int Pixels(const CsvRow& row, size_t field) {
  const double value = CsvNumber(row, field, kRemedy);
  if (value >= 1 && value <= 1e6) return static_cast<int>(value);
  throw Error(row.where, "the picture's size '" + row.fields[field] + "' is none", kRemedy);
}

MarkerSighting ParseRow(const CsvRow& row) {
  if (row.fields.size() != kNumFields) {
    throw Error(row.where,
                "has " + std::to_string(row.fields.size()) + " fields instead of " +
                    std::to_string(kNumFields),
                kRemedy);
  }
  if (row.fields[0].empty() || row.fields[1].empty()) {
    throw Error(row.where, "names no marker or no picture", kRemedy);
  }
  MarkerSighting sighting{row.fields[0], row.fields[1], Pixels(row, 2), Pixels(row, 3), {}, false};
  for (size_t k = 0; k < 4; ++k) {
    sighting.corners[k] = {CsvNumber(row, 4 + 2 * k, kRemedy), CsvNumber(row, 5 + 2 * k, kRemedy)};
  }
  sighting.is_mirrored = CsvNumber(row, kNumFields - 1, kRemedy) != 0;
  return sighting;
}

}  // namespace

std::string MarkersCsv(const std::vector<MarkerSighting>& sightings) {
  std::string text = std::string(kMarkersHeader) + "\n";
  for (const MarkerSighting& sighting : sightings) text += Row(sighting);
  return text;
}

std::vector<MarkerSighting> ReadMarkersCsv(const std::filesystem::path& path) {
  const CsvTable table = ReadCsvTable(path, "--markers_path");
  if (table.header != kMarkersHeader) {
    throw Error(path.string(), "is no table of markers", kRemedy);
  }
  std::vector<MarkerSighting> sightings;
  for (const CsvRow& row : table.rows) sightings.push_back(ParseRow(row));
  return sightings;
}

}  // namespace colmap_seapoint
