#include "colmap_seapoint/pictures/model_inputs.h"

#include <algorithm>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {

void CheckModelPictures(const ModelPictures& pictures, const SparseModel& model,
                        const std::filesystem::path& image_path, const std::string& model_path) {
  std::string first_problem;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const std::string problem = pictures.Check(static_cast<int>(i));
    if (problem.empty()) return;
    if (first_problem.empty()) first_problem = model.images[i].name + ": " + problem;
  }
  if (model.images.empty()) {
    throw Error(model_path, "the model holds no pictures", "give a model of COLMAP's mapper");
  }
  throw Error(image_path.string(),
              "none of the model's " + std::to_string(model.images.size()) +
                  " pictures can be used (" + first_problem + ")",
              "give the --image_path that the model was made from, reduced or in full");
}

std::vector<RunReport::Input> DescribeModelInputs(const ModelPictures& pictures, size_t num_images,
                                                  const std::filesystem::path& model_path,
                                                  int num_threads) {
  std::vector<std::string> model_files;
  for (const auto& entry : std::filesystem::directory_iterator(model_path)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".bin" || extension == ".txt") model_files.push_back(entry.path().string());
  }
  std::sort(model_files.begin(), model_files.end());
  std::vector<RunReport::Input> inputs(num_images + model_files.size());
  ParallelFor(num_threads, static_cast<int64_t>(inputs.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    if (i < num_images) {
      inputs[i] = pictures.Describe(static_cast<int>(i));
    } else {
      const std::string& path = model_files[i - num_images];
      inputs[i] = DescribeInput(path, path);
    }
  });
  return inputs;
}

}  // namespace colmap_seapoint
