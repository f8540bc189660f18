// The folders and files of a workspace of automatic_reconstructor.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

// Absolute paths. <k> below sparse, scaled, dense and maps is the number of the mapper's model.
struct Workspace {
  Workspace(const std::string& image_path, const std::string& workspace_path)
      : images(std::filesystem::absolute(image_path).lexically_normal()),
        root(std::filesystem::absolute(workspace_path).lexically_normal()),
        database(root / "database.db"),
        sparse(root / "sparse"),
        scaled(root / "sparse_scaled"),
        dense(root / "dense"),
        maps(root / "map"),
        markers(root / "found_markers.csv"),
        report(root / "report") {}

  // What the chain makes directly in the root: checked, and made ours, before anything else is
  // done. The database's are there while it is begun anew, those of sparse while the mapper runs.
  std::vector<std::string> Names() const {
    return {"database.db",   "database.db.tmp", "sparse", "sparse.tmp",        "sparse.tmp.db",
            "sparse_scaled", "dense",           "map",    "found_markers.csv", "report"};
  }

  std::filesystem::path images, root, database, sparse, scaled, dense, maps, markers, report;
};

}  // namespace colmap_seapoint
