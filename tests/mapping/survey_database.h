// An exact survey on the disk: keypoints and verified matches along its tracks, and pictures.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// Every two pictures that see a point in common are a verified pair. Ids as in the survey, which
// must count them from 1.
void WriteSurveyDatabase(const SparseModel& survey, const std::filesystem::path& path);

// A picture for each of the survey, of another size than its camera's: there is nothing to measure.
void WriteTinyPictures(const SparseModel& survey, const std::filesystem::path& folder);

}  // namespace colmap_seapoint
