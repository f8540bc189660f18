// Exact surveys as two models of them, each in a frame and a scale of its own.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// A place of the ground and what it looks like: places of the same number look alike, and a
// database matches them.
struct GroundPoint {
  Eigen::Vector3d xyz;
  int looks = 0;
};

// Points strewn over [x0, x1] x [y0, y1], about 2 below the cameras, with relief; `looks` count
// from first_looks.
std::vector<GroundPoint> StrewnGround(double x0, double x1, double y0, double y1, int count,
                                      int first_looks, int seed);

// Straight down from (x, y, 0) with a little turn; 800 x 600 pixels, focal length 800.
PosedImage PictureAt(uint32_t image_id, double x, double y);

// What the pictures see of the ground, exactly; features stand in the order of the ground. Points
// of two pictures or more are triangulated. `looks[image_id][feature]` comes out.
struct TestModel {
  SparseModel model;
  std::map<uint32_t, std::vector<int>> looks;
};
TestModel SeenBy(std::vector<PosedImage> images, const std::vector<GroundPoint>& ground);

// In a frame and a scale of its own.
Similarity3d OtherFrame();

// Every pair of pictures, within the models and across, is matched by what its SeaPoints look like.
void WriteDatabase(const TestModel& a, const TestModel& b, const std::filesystem::path& path);

}  // namespace colmap_seapoint
