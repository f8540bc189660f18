// The two forms of a model, and what both check. For colmap_model*.cc only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"

namespace colmap_seapoint {

// The place of a record in its file, for messages: "byte 120" or "line 7".
class RecordPlace {
 public:
  RecordPlace(const std::filesystem::path& path, const char* unit, uint64_t position)
      : path_(path), unit_(unit), position_(position) {}

  // Throws Error "<path>: <unit> <position>: <finding>; <remedy>".
  [[noreturn]] void Fail(const std::string& finding) const;

 private:
  const std::filesystem::path& path_;
  const char* unit_;
  uint64_t position_;
};

struct ModelBeingRead {
  ModelContent content = ModelContent::kAll;
  SparseModel model;
  std::vector<size_t> num_features;  // of each image
};

// Check one record and add it to the model. Throw Error at `place`.
void AddCamera(const RecordPlace& place, uint32_t camera_id, int model_id, uint64_t width,
               uint64_t height, std::vector<double> params, ModelBeingRead* read);
// qvec: w, x, y, z, normalised here. Takes what `image` holds, or copies what is kept of it, so
// that its vectors serve for the next image: a heap full of holes would cost as much as they do.
void AddImage(const RecordPlace& place, const Eigen::Vector4d& qvec, PosedImage* image,
              ModelBeingRead* read);
void AddPoint(const RecordPlace& place, uint64_t point3D_id, SparsePoint point,
              ModelBeingRead* read);

void ReadModelBinary(const std::filesystem::path& dir, ModelBeingRead* read);
void ReadModelText(const std::filesystem::path& dir, ModelBeingRead* read);

// The picture ids of every frame's cameras, as they stand there.
std::vector<std::vector<uint64_t>> ReadFramesBinary(const std::filesystem::path& path);
std::vector<std::vector<uint64_t>> ReadFramesText(const std::filesystem::path& path);

}  // namespace colmap_seapoint
