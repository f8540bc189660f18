// A demo survey with gaps of known causes planted into its pictures and its model.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {

struct Disc {  // on the ground's plan, metres
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 0;
  bool Contains(const Eigen::Vector2d& place) const { return (place - center).norm() < radius; }
};

struct PlantedGaps {
  std::vector<Disc> smooth;       // sand without texture
  std::vector<Disc> moving;       // another pattern in every picture, as of kelp
  std::set<std::string> blurred;  // pictures, by name
  std::set<std::string> lost;     // pictures that are in no model
  std::set<std::string> removed;  // pictures that were never taken
};

// Chosen by the seed: a smooth and a moving disc, three blurred, three lost and some removed
// pictures in a row, each on a strip of its own as far as there are strips.
PlantedGaps ChooseGaps(const SurveyTruth& truth, int num_strips, int seed);

// The picture as it would have been.
void PlantInPicture(const SurveyTruth& truth, const PlantedGaps& gaps, const PosedImage& image,
                    ColorImage* picture);

void WritePlantedGaps(const std::filesystem::path& path, const PlantedGaps& gaps);
PlantedGaps ReadPlantedGaps(const std::filesystem::path& path);

}  // namespace colmap_seapoint
