#include "colmap_seapoint/markers/marker_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <set>
#include <sstream>

#include "colmap_seapoint/markers/marker_codes.h"

namespace colmap_seapoint {
namespace {

struct Spelling {
  const char* text;  // small letters
  MarkerFamily family;
};

constexpr std::array<Spelling, 6> kSpellings = {{{"tag36h11", MarkerFamily::kTag36h11},
                                                 {"apriltag36h11", MarkerFamily::kTag36h11},
                                                 {"dict_apriltag_36h11", MarkerFamily::kTag36h11},
                                                 {"dict_4x4", MarkerFamily::kAruco4x4},
                                                 {"dict_5x5", MarkerFamily::kAruco5x5},
                                                 {"dict_6x6", MarkerFamily::kAruco6x6}}};
constexpr std::array<int, 4> kArucoSizes = {50, 100, 250, 1000};

std::string SmallLetters(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// A family, and how many of its markers the spelling means.
struct Dictionary {
  MarkerFamily family;
  int size;
};

std::optional<Dictionary> ParseDictionary(const std::string& text) {
  const std::string small = SmallLetters(text);
  for (const Spelling& spelling : kSpellings) {
    if (small == spelling.text) return Dictionary{spelling.family, NumMarkers(spelling.family)};
    if (spelling.family == MarkerFamily::kTag36h11) continue;
    for (const int size : kArucoSizes) {
      if (small == spelling.text + ("_" + std::to_string(size))) {
        return Dictionary{spelling.family, size};
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::string FamilyText(MarkerFamily family) {
  switch (family) {
    case MarkerFamily::kAruco4x4:
      return "DICT_4X4";
    case MarkerFamily::kAruco5x5:
      return "DICT_5X5";
    case MarkerFamily::kAruco6x6:
      return "DICT_6X6";
    default:
      return "tag36h11";
  }
}

std::string MarkerText(const MarkerName& name) {
  return FamilyText(name.family) + ":" + std::to_string(name.id);
}

std::optional<MarkerFamily> ParseMarkerFamily(const std::string& text) {
  const auto dictionary = ParseDictionary(text);
  return dictionary ? std::optional<MarkerFamily>(dictionary->family) : std::nullopt;
}

ParsedMarker ParseMarkerName(const std::string& text) {
  ParsedMarker parsed;
  const size_t colon = text.find(':');
  if (colon == std::string::npos) return parsed;
  const auto dictionary = ParseDictionary(text.substr(0, colon));
  if (!dictionary) return parsed;
  const char *begin = text.data() + colon + 1, *end = text.data() + text.size();
  int id = -1;
  const auto number = std::from_chars(begin, end, id);
  if (number.ec != std::errc() || number.ptr != end || id < 0 || id >= dictionary->size) {
    parsed.problem =
        text.substr(0, colon) + " has the markers 0 to " + std::to_string(dictionary->size - 1);
    return parsed;
  }
  parsed.name = MarkerName{dictionary->family, id};
  return parsed;
}

std::optional<std::vector<MarkerFamily>> ParseMarkerFamilies(const std::string& text) {
  std::set<MarkerFamily> families;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const auto family = ParseMarkerFamily(word);
    if (!family) return std::nullopt;
    families.insert(*family);
  }
  if (families.empty()) return std::nullopt;
  return std::vector<MarkerFamily>(families.begin(), families.end());
}

}  // namespace colmap_seapoint
