// What cloud_comparer leaves to look at: both clouds coloured by their distances, and a picture.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "colmap_seapoint/compare/compare_clouds.h"
#include "colmap_seapoint/io/cloud/distance_cloud.h"

namespace colmap_seapoint {

// Writes input_to_reference.ply, reference_to_input.ply (points in order of the tiles, each with
// its distance; beyond max_distance: that, in magenta) and differences.png (the input above, the
// reference below, seen along the smallest axis) into a folder, which is created. Colours: blue at
// 0, green, red from the largest of the distances on. Throws Error when a file cannot be written.
class DifferenceFiles {
 public:
  explicit DifferenceFiles(const std::filesystem::path& folder) : folder_(folder) {}

  void Begin(const CompareSetup& setup);
  void Add(bool of_input, const PointVector& points, const std::vector<double>& squared);
  void Finish();

 private:
  struct Side {
    std::unique_ptr<DistanceCloudWriter> cloud;
    std::unique_ptr<PlanPicture> picture;
  };

  std::filesystem::path folder_;
  double scale_ = 1, max_distance_ = 1;
  Side input_, reference_;
};

}  // namespace colmap_seapoint
