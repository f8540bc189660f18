// Hybrid resolution (paper 4): poses from reduced pictures, the dense cloud from full ones.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// Gives every image of the model whose picture is larger or smaller than its camera, in the same
// proportions, a camera of that size (ScaledCamera; a new id, shared by the pictures of one camera
// and one size), and moves its points2D with it. Pictures that cannot be read, or have other
// proportions, keep their camera. Returns how many have a new one. Reads headers only, on
// `num_threads` (-1 = all).
int ScaleCamerasToPictures(const std::filesystem::path& image_path, int num_threads,
                           SparseModel* model);

}  // namespace colmap_seapoint
