// colmap_seapoint::pipeline from outside: a folder of pictures -> dense clouds, the whole chain.
//   reconstruct_folder IMAGE_FOLDER WORKSPACE_FOLDER
#include <exception>
#include <iostream>

#include "colmap_seapoint/pipeline/reconstruct.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: reconstruct_folder IMAGE_FOLDER WORKSPACE_FOLDER\n";
    return 2;
  }
  colmap_seapoint::AutomaticReconstructorOptions options;
  options.image_path = argv[1];
  options.workspace_path = argv[2];
  options.quality = "field";
  try {
    const auto result = colmap_seapoint::RunAutomaticReconstructor(options);
    std::cout << result.text;
    return result.is_complete ? 0 : 3;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
