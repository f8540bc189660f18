// How large the sensors of known cameras are: LensFun's database, as Debian packages it.
#pragma once

#include <optional>
#include <string>

namespace colmap_seapoint {

struct SensorSize {
  double diagonal_mm = 0;
  bool is_four_thirds = false;  // its sides are as 4 to 3, else as 3 to 2
};

// Maker and model as EXIF has them, in any case of the letters; of the maker the first word
// decides, since firms change their names. nullopt for a camera that the database does not hold,
// where it holds two of different sizes, and where there is no database. The first call reads it
// (50 ms); may be called from several threads. Throws Error when a disk fails.
std::optional<SensorSize> FindSensor(const std::string& maker, const std::string& model);

}  // namespace colmap_seapoint
