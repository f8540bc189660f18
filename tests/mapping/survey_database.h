// An exact survey as a database holds it: keypoints, and verified matches along its tracks.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// Every two pictures that see a point in common are a verified pair. Ids as in the survey, which
// must count them from 1.
void WriteSurveyDatabase(const SparseModel& survey, const std::filesystem::path& path);

}  // namespace colmap_seapoint
