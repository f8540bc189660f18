// From how near the points of a cloud were seen.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// By point, in the model's unit a pixel: the mean of GsdAt over the pictures that `<cloud>.vis`
// names for it. Empty without such a file. Throws Error for one that is damaged, belongs to another
// number of points or names a picture that the model has not.
std::vector<float> ViewGsd(const SparseModel& model, const std::vector<Eigen::Vector3f>& points,
                           const std::filesystem::path& cloud_path);

}  // namespace colmap_seapoint
