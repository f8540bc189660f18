// Any files as a model, in either form: for model_bin_fuzz.cc and model_txt_fuzz.cc.
#pragma once

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/colmap_rigs.h"
#include "tests/fuzz/fuzz_files.h"

namespace colmap_seapoint {

inline void ReadAnyModel(const std::filesystem::path& folder,
                         void (*write)(const std::filesystem::path&, const SparseModel&)) {
  SparseModel model;
  const bool is_model = Accepts([&] { model = ReadSparseModel(folder); });
  for (const ModelContent content : {ModelContent::kPosesAndPoints, ModelContent::kTriangulated}) {
    SparseModel part;
    const bool is_part = Accepts([&] { part = ReadSparseModel(folder, content); });
    FUZZ_REQUIRE(is_part == is_model && part.points3D.size() == model.points3D.size());
  }
  Accepts([&] { ReadFrames(folder, model); });
  const std::filesystem::path again = FuzzFolder() / "again";
  std::filesystem::create_directories(again);
  Accepts([&] { TransformRigFiles(folder, again, Similarity3d()); });
  if (!is_model) return;
  // What we read we write, and read again.
  FUZZ_REQUIRE(Accepts([&] { write(again, model); }));
  SparseModel read;
  FUZZ_REQUIRE(Accepts([&] { read = ReadSparseModel(again); }));
  FUZZ_REQUIRE(read.cameras.size() == model.cameras.size());
  FUZZ_REQUIRE(read.images.size() == model.images.size());
  FUZZ_REQUIRE(read.points3D.size() == model.points3D.size());
  std::filesystem::remove_all(again);
}

}  // namespace colmap_seapoint
