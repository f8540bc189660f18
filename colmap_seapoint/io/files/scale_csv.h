// Scale bars, and targets marked in pictures, from tables that the user brings.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace colmap_seapoint {

// One end of a bar: a target by its name, or a 3D point of the model, written point:ID.
struct ScaleBarEnd {
  std::string name;  // as it stands there
  std::optional<uint64_t> point3D_id;
};

struct ScaleBar {
  ScaleBarEnd ends[2];
  double metres = 0;
  std::optional<double> sigma;  // metres; nullopt: the table does not say
  std::string where;            // "<file>:<line>"
};

// Header "name1,name2,length_m" or "name1,name2,length_m,sigma_m", then one bar a line; in general
// as ReadCsvTable. Throws Error with file, line, finding and remedy: another header, a row of
// another length, an end without a name, both ends the same, a length or sigma that is no positive
// number, an illegal point ID, no row at all.
std::vector<ScaleBar> ReadScaleBarsCsv(const std::filesystem::path& path);

struct TargetMark {
  std::string target, image;
  Eigen::Vector2d pixel;  // COLMAP's convention: the first pixel's centre is (0.5, 0.5)
  std::string where;      // "<file>:<line>"
};

// Header "target,image,x,y", then one mark a line. Throws Error as above, and when a target is
// marked twice in one picture.
std::vector<TargetMark> ReadTargetsCsv(const std::filesystem::path& path);

}  // namespace colmap_seapoint
