// The options of a map, as the command and the whole chain have them.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

struct OrthomosaicOptions;

struct MapSettings {
  double pixel_size = 0;       // of the model's unit; 0 = the survey's ground sampling distance
  bool fill = false;           // also what lies between measured cells; marked in surface.tif
  std::string plane = "auto";  // auto, model, fitted, or x,y,z: the direction it is seen from
  std::string up;              // x,y,z: what points to the upper edge; empty = north, or as found
  std::string color = "raw";   // raw, or balanced: without the water, for the eye

  // Names are "<prefix>pixel_size" and so on.
  void Bind(OptionTable* table, const std::string& prefix = "");
  // "" or the whole sentence: name, value, rule.
  std::string Check() const;
  // Of settings that Check() has nothing against.
  OrthomosaicOptions Options(int num_threads) const;
};

}  // namespace colmap_seapoint
