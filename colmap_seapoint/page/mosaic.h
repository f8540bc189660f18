// The orthomosaic under the map of gaps.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>

#include "colmap_seapoint/base/image.h"
#include "densify/completeness/surface/plan_frame.h"

namespace colmap_seapoint {

struct Mosaic {
  ColorImage picture;
  // Pixels (column, row, 1) to the plan's x and y, units.
  Eigen::Matrix<double, 2, 3> plan_from_pixel;
};

// The preview in a folder that `orthomosaic` made (map.json, orthomosaic.jpg), made smaller until
// its longer side has max_side pixels. The two plans may be inclined to each other (map_frame.h):
// places as high as `middle` (world) lie where they belong. nullopt where there is no such map.
// Throws Error for a map.json that is none of ours.
std::optional<Mosaic> ReadMosaic(const std::filesystem::path& folder, const PlanFrame& plan,
                                 const Eigen::Vector3d& middle, int max_side);

}  // namespace colmap_seapoint
