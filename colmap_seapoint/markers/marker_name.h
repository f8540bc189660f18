// How tables and people name a coded marker: family and number, "tag36h11:12" or "DICT_4X4_50:3".
#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace colmap_seapoint {

// AprilTag's 36h11, and ArUco's predefined dictionaries; the smaller ones of a size (DICT_4X4_50)
// are the first markers of the largest.
enum class MarkerFamily { kTag36h11, kAruco4x4, kAruco5x5, kAruco6x6 };

struct MarkerName {
  MarkerFamily family = MarkerFamily::kTag36h11;
  int id = 0;

  bool operator==(const MarkerName& other) const {
    return family == other.family && id == other.id;
  }
  bool operator<(const MarkerName& other) const {
    return std::tie(family, id) < std::tie(other.family, other.id);
  }
};

// "tag36h11", "DICT_4X4", "DICT_5X5", "DICT_6X6".
std::string FamilyText(MarkerFamily family);
// "tag36h11:12": the one name of it, whatever it was called in a table.
std::string MarkerText(const MarkerName& name);

// In any case of letters; also "apriltag36h11", OpenCV's "DICT_APRILTAG_36h11", and
// "DICT_5X5_100" with the size of a dictionary. nullopt for other text.
std::optional<MarkerFamily> ParseMarkerFamily(const std::string& text);

// What the text of a table's field means, where it has the form FAMILY:NUMBER.
struct ParsedMarker {
  std::optional<MarkerName> name;  // nullopt: the text names no marker
  // Not empty: the family is known, but it has no such number; the rule as a sentence's end.
  std::string problem;
};
ParsedMarker ParseMarkerName(const std::string& text);

// "tag36h11,DICT_4X4": families with commas between them, each once, in the order of the enum;
// nullopt when one of them is unknown, or none is given.
std::optional<std::vector<MarkerFamily>> ParseMarkerFamilies(const std::string& text);

}  // namespace colmap_seapoint
