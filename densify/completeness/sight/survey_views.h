// The pictures of a model as what sees the ground.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "densify/completeness/surface/ground.h"

namespace colmap_seapoint {

struct SurveyView {
  const Camera* camera = nullptr;
  Eigen::Matrix3d rotation;  // camera from world
  Eigen::Vector3d translation, center;
  bool is_fisheye = false;
  double max_angle = 0;  // radians from the axis to the farthest corner
  double max_range = 0;  // units; what is farther is lost in the water

  // The pixel of a place in the world; nullopt outside of the picture, and beyond max_range.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& place) const;
  // Whether something of a sphere may be in the picture. False is certain.
  bool MaySee(const Eigen::Vector3d& middle, double radius) const;
  // Units a pixel: by the depth, in a fisheye's picture by the distance.
  double GsdAt(const Eigen::Vector3d& place) const;
};

SurveyView MakeView(const Camera& camera, const Rigid3d& cam_from_world, double max_range);
// In the order of model.images.
std::vector<SurveyView> MakeViews(const SparseModel& model, double max_range);

// How far the survey's pictures see: 1.25 times what 98 % of the model's observations stay below.
// Infinite for a model without points.
double VisualRange(const SparseModel& model);

// The cloud as a view sees it, nearest first, on cells of kDepthCell pixels: depths along z, to
// 1/65535 of the farthest that is drawn.
inline constexpr int kDepthCell = 8;
struct DepthCells {
  Image<uint16_t> codes;  // depth / unit; 0 where nothing is
  double unit = 1;

  DepthCells() = default;
  DepthCells(int width, int height, double farthest);
  bool Holds(int x, int y) const { return codes.At(x, y) > 0; }
  double DepthAt(int x, int y) const { return unit * codes.At(x, y); }
  // Keeps the nearer one.
  void Draw(int x, int y, uint16_t code) {
    uint16_t& nearest = codes.At(x, y);
    if (nearest == 0 || code < nearest) nearest = code;
  }
  uint16_t CodeOf(double depth) const;
};
// One a view. Cells of the ground that hold points are drawn as discs. 0.04 microseconds a cell and
// view; 2 bytes a depth cell.
std::vector<DepthCells> DrawDepths(const Ground& ground, const std::vector<SurveyView>& views,
                                   int num_threads);
// Whether a view shows another surface of the cloud at that pixel than a place of that depth: one
// before it, which hides it; or one behind it, and then the place is not where it was predicted,
// for instance in the shadow of a boulder, over which the prediction slopes down. `slack`: units.
bool ShowsAnother(const DepthCells& depths, const Eigen::Vector2d& pixel, double depth,
                  double slack);

}  // namespace colmap_seapoint
