// Clouds against clouds with every pair of points, straight from the definitions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "colmap_seapoint/compare/cloud_comparison.h"
#include "colmap_seapoint/compare/plan_view.h"
#include "colmap_seapoint/compare/point_tiles.h"

namespace colmap_seapoint {

// Lengths and view are taken from `setup`; every figure is worked out anew.
CloudComparison CompareByBruteForce(const PointVector& input, const PointVector& reference,
                                    const CloudComparison& setup, const PlanView& view);

double SpacingByBruteForce(const PointVector& cloud);

// A binary PLY of x y z as doubles.
void WriteDoublePly(const std::filesystem::path& path, const PointVector& points);
// As floats; every coordinate must be one.
void WriteFloatPly(const std::filesystem::path& path, const PointVector& points);

}  // namespace colmap_seapoint
