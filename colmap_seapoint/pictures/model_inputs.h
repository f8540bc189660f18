// What a command that works on a model and its pictures asks of them first, and notes of them last.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pictures/model_pictures.h"

namespace colmap_seapoint {

// Sees a folder of foreign pictures before hours of work: throws Error when the model has no
// pictures, or none of them can be used. Reads headers up to the first one that can.
void CheckModelPictures(const ModelPictures& pictures, const SparseModel& model,
                        const std::filesystem::path& image_path, const std::string& model_path);

// Size and hash of the model's pictures, in its order, then of the files of its folder, by name. On
// `num_threads`: a picture that was not read yet is read now.
std::vector<RunReport::Input> DescribeModelInputs(const ModelPictures& pictures, size_t num_images,
                                                  const std::filesystem::path& model_path,
                                                  int num_threads);

}  // namespace colmap_seapoint
