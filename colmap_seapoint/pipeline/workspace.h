// The folders and files of a workspace of automatic_reconstructor.
#pragma once

#include <filesystem>
#include <string>

namespace colmap_seapoint {

// Absolute paths. <k> below sparse, scaled and dense is the number of the mapper's model.
struct Workspace {
  Workspace(const std::string& image_path, const std::string& workspace_path)
      : images(std::filesystem::absolute(image_path).lexically_normal()),
        root(std::filesystem::absolute(workspace_path).lexically_normal()),
        database(root / "database.db"),
        sparse(root / "sparse"),
        scaled(root / "sparse_scaled"),
        dense(root / "dense"),
        report(root / "report") {}

  std::filesystem::path images, root, database, sparse, scaled, dense, report;
};

}  // namespace colmap_seapoint
