// COLMAP's model folders, binary and text, 3.8 to 4.x (rigs.bin is ignored: the camera poses of
// images.bin already contain it). The only place that knows their format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// How much of a model is kept.
enum class ModelContent {
  kAll,
  // What densification needs, in a third of the memory of a model with all its features: points2D
  // stay empty, and point3D_ids are those of the triangulated features alone, in their order.
  // Cannot be written again.
  kPosesAndPoints,
  // The same, with the places of the triangulated features. Tracks still tell the features' numbers
  // in the file, so that it cannot be written again either before they are made anew.
  kTriangulated,
};

// Reads cameras, images and points3D from `dir`; binary is preferred when both exist. Throws Error
// naming the file and the byte or line for anything missing, truncated, inconsistent or not
// finite, for camera models that FindCameraModel does not know, for image names that are absolute
// or contain "..", and for point/image ids that point nowhere.
SparseModel ReadSparseModel(const std::filesystem::path& dir,
                            ModelContent content = ModelContent::kAll);

using Frame = std::vector<uint32_t>;  // image_ids

// The groups of pictures, two at least, that a rig took at the same moment: frames.bin, or
// frames.txt of a text model (3.12 and later). Empty when there is no such file. Throws Error for a
// damaged file and for a picture that stands in two frames.
std::vector<Frame> ReadFrames(const std::filesystem::path& dir, const SparseModel& model);

// True when `dir` holds cameras/images/points3D in either form.
bool IsSparseModel(const std::filesystem::path& dir);

// The files that a model's folder may hold, in either form, with COLMAP's record of its options.
std::vector<std::string> ModelFileNames();
bool IsModelFile(const std::string& name);

// Write all three files; each is written under a temporary name and renamed. `dir` is created. Rigs
// and frames that are there are removed, whose poses would count more than those written here.
void WriteSparseModelText(const std::filesystem::path& dir, const SparseModel& model);
void WriteSparseModelBinary(const std::filesystem::path& dir, const SparseModel& model);

// fused.ply.vis counts pictures by their place in images.bin (COLMAP 3.8) or by the order of their
// ids (later versions): in a model so sorted both are the same.
void SortImagesById(SparseModel* model);

}  // namespace colmap_seapoint
