// A cloud seen from above: the frame of that view, and pictures in it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// Right and down span the plan, up points to the viewer. Right is the longest direction of the
// cloud, up the smallest one.
struct PlanView {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // rows: right, down, up; orthonormal
  // Bounds of all but a thousandth of the points at either end: right, down, up, from the centre.
  Eigen::Array3d low = Eigen::Array3d::Zero(), high = Eigen::Array3d::Zero();

  Eigen::Vector3d FromWorld(const Eigen::Vector3d& xyz) const { return axes * (xyz - center); }
};

// The view of two clouds together (one may be empty, not both), from their points or an even sample
// of them. What lies far outside of 98 % of the points does not turn the view. Up is the side that
// `normal_sum` points to; where that is zero, its largest component is positive. The result does
// not depend on which cloud comes first.
PlanView FitPlanView(const std::vector<Eigen::Vector3d>& points_a,
                     const std::vector<Eigen::Vector3d>& points_b,
                     const Eigen::Vector3d& normal_sum);

// Narrows the bounds to those of 98 % of the points at each axis, and `margin` of that extent
// beyond them: one point in fifty may lie anywhere without making the rest small.
void TrimPlanView(const std::vector<Eigen::Vector3d>& points, double margin, PlanView* view);

// From blue at 0 over green to red at 1; a share outside counts as the nearer end.
std::array<uint8_t, 3> RampColor(double share);

// A picture of a cloud from above: the highest point of each pixel, the first one of several at one
// height; black where there is none.
class PlanPicture {
 public:
  // `width` pixels for the view's longer direction; the height follows, up to `max_height`.
  PlanPicture(const PlanView& view, int width, int max_height);
  void Add(const Eigen::Vector3d& xyz, const std::array<uint8_t, 3>& rgb);
  const ColorImage& Picture() const { return picture_; }
  double PixelsAUnit() const { return scale_; }

 private:
  PlanView view_;
  double scale_ = 1;  // pixels a unit
  ColorImage picture_;
  FloatImage top_;
};

// Two pictures of one width, one below the other, with a thin white line between them.
ColorImage StackPictures(const ColorImage& above, const ColorImage& below);

}  // namespace colmap_seapoint
