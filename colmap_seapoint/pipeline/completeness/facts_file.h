// What was measured in the pictures of a survey, kept between the runs of a workspace, so that a
// survey that grows measures its new pictures alone. Ours alone, and never needed.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "densify/completeness/sight/picture_facts.h"

namespace colmap_seapoint {

struct MeasuredPicture {
  std::string content;  // of picture and mask: changes when either does
  PictureFacts facts;   // as MeasurePicture() gave them, not judged
  double brightness = -1;
};

using MeasuredPictures = std::map<std::string, MeasuredPicture>;  // by name

// Atomic. Throws Error.
void WriteMeasuredPictures(const std::filesystem::path& path, const MeasuredPictures& pictures);
// Empty where there is no such file, or another version or a damaged disk left another one: the
// pictures are measured then.
MeasuredPictures ReadMeasuredPictures(const std::filesystem::path& path);

}  // namespace colmap_seapoint
