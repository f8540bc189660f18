// A strip of small pictures with an exact geometry: a flat textured ground seen from straight above
// by a pinhole camera that moves along x, so that picture i is a window shifted by i steps.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

inline constexpr int kStripWidth = 400;
inline constexpr int kStripHeight = 300;
inline constexpr int kStripStep = 90;     // pixels between neighbours
inline constexpr double kStripRange = 2;  // world units between cameras and ground

// Picture `index` of the strip.
ColorImage StripPicture(int index);

// "<folder>/<prefix>1.png", 2, ... `count`.
void WriteStrip(const std::filesystem::path& folder, int count, const std::string& prefix = "img");

// The pose of the picture with this name: its last number is its place in the strip.
Rigid3d StripPose(const std::string& name, const Camera& camera);

// The exact model of WriteStrip's pictures, with ground points on a lattice.
SparseModel StripModel(int count, const std::string& prefix = "img");

}  // namespace colmap_seapoint
