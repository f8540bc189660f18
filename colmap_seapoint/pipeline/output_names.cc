#include "colmap_seapoint/pipeline/output_names.h"

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/dense_workspace.h"
#include "colmap_seapoint/io/files/model_units.h"

namespace colmap_seapoint {

using Names = std::vector<std::string>;

Names CloudNames() { return {"fused.ply", "fused.ply.vis", "pairs.csv", kUnitsFile, "run.json"}; }

Names DenseMapNames(const Names& pictures) {
  Names names = {"stereo/fusion.cfg", "stereo/patch-match.cfg"};
  for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    names.push_back("sparse/" + std::string(file));
  }
  for (const std::string& picture : pictures) {
    for (const auto& path : {UndistortedImagePath("", picture), DepthMapPath("", picture),
                             NormalMapPath("", picture)}) {
      names.push_back(path.generic_string());
    }
  }
  return names;
}

Names ScaledModelNames() {
  Names names = ModelFileNames();
  names.insert(names.end(), {"scale.json", kUnitsFile, "run.json"});
  return names;
}

Names DifferenceNames() {
  return {"input_to_reference.ply", "reference_to_input.ply", "differences.png"};
}

}  // namespace colmap_seapoint
