// Where a model's size and place are known from: tables of scale bars, targets and positions, a
// navigation log, the spacing of a rig, the size of coded markers.
#pragma once

#include <optional>
#include <string>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// The ranges and the tables' columns stand in the .cc file, where each field is bound to its
// option.
inline constexpr char kNoPositions[] = "none";
inline constexpr char kAutoOffset[] = "auto";

struct ScaleSources {
  std::string scale_bars_path;  // CSV of known lengths, metres; empty = none
  std::string targets_path;     // CSV of the targets' marks in the pictures; empty = none
  std::string positions_path;   // CSV of the cameras' positions; empty = those of EXIF where
                                // nothing else is given; kNoPositions = not even those
  std::string nav;              // CSV of the vehicle's log, several separated by commas
  std::string nav_times;        // CSV of the pictures' times; empty = EXIF's
  std::string nav_offset = kAutoOffset;  // log's clock minus camera's, seconds
  double max_nav_offset = 120;           // that is looked for, seconds
  std::string crs;                       // "EPSG:32755"; empty = east, north, up of the place
  double rig_spacing = 0;                // between the two cameras of a rig, metres; 0 = unknown
  double marker_size = 0;                // side of the markers' black squares, metres; 0 = unknown
  std::string marker_families = "tag36h11";  // of the markers that have marker_size
  double length_sigma = 0.001;               // of lengths that do not give theirs, metres
  double max_target_error = 4;               // of a mark that is used, pixels

  void Bind(OptionTable* table);
  // Whether the user has given any: else EXIF is asked.
  bool Any() const;
  bool HasPositionTable() const { return !positions_path.empty() && !DeclinesPositions(); }
  bool DeclinesPositions() const { return positions_path == kNoPositions; }
  // nullopt: it is to be found.
  std::optional<double> NavOffset() const;
  // "", or the whole sentence about options that do not go together.
  std::string Check() const;
};

}  // namespace colmap_seapoint
