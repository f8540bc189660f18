#include "colmap_seapoint/compare/plan_view.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr int kLineHeight = 2;  // pixels between stacked pictures
constexpr double kCoreTrim = 0.01;

using Points = std::vector<Eigen::Vector3d>;

// The smallest and the largest value when a `share` of them is left out at either end.
std::array<double, 2> TrimmedBounds(std::vector<double> values, double share) {
  const auto skip = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + skip, values.end());
  const double low = values[static_cast<size_t>(skip)];
  std::nth_element(values.begin(), values.end() - 1 - skip, values.end());
  return {low, values[values.size() - 1 - static_cast<size_t>(skip)]};
}

std::vector<double> Positions(const Points& a, const Points& b, const Eigen::Vector3d& direction,
                              const Eigen::Vector3d& center) {
  std::vector<double> values;
  values.reserve(a.size() + b.size());
  for (const Points* points : {&a, &b}) {
    for (const Eigen::Vector3d& xyz : *points) values.push_back(direction.dot(xyz - center));
  }
  return values;
}

struct Scatter {
  double count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
};

// The scatter of the points in the box, about its centre.
Scatter ScatterInBox(const Points& points, const Eigen::Array3d& low, const Eigen::Array3d& high) {
  Scatter scatter;
  const Eigen::Vector3d center = 0.5 * (low + high);
  for (const Eigen::Vector3d& xyz : points) {
    if ((xyz.array() < low).any() || (xyz.array() > high).any()) continue;
    const Eigen::Vector3d offset = xyz - center;
    scatter.count += 1;
    scatter.sum += offset;
    scatter.products += offset * offset.transpose();
  }
  return scatter;
}

// The direction or its opposite, whichever has its largest component positive.
Eigen::Vector3d Positive(const Eigen::Vector3d& direction) {
  Eigen::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction[largest] < 0 ? -direction : direction;
}

}  // namespace

PlanView FitPlanView(const Points& points_a, const Points& points_b,
                     const Eigen::Vector3d& normal_sum) {
  SEAPOINT_CHECK(!points_a.empty() || !points_b.empty());
  constexpr double kBoundsTrim = 0.001;
  Eigen::Array3d low, high;
  for (int i = 0; i < 3; ++i) {
    const auto bounds = TrimmedBounds(
        Positions(points_a, points_b, Eigen::Vector3d::Unit(i), Eigen::Vector3d::Zero()),
        kCoreTrim);
    const double margin = bounds[1] - bounds[0];
    low[i] = bounds[0] - margin;
    high[i] = bounds[1] + margin;
  }
  const Scatter a = ScatterInBox(points_a, low, high), b = ScatterInBox(points_b, low, high);
  const double count = std::max(1.0, a.count + b.count);
  const Eigen::Vector3d mean = (a.sum + b.sum) / count;
  const Eigen::Matrix3d products = a.products + b.products;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(products / count -
                                                              mean * mean.transpose());
  PlanView view;
  view.center = 0.5 * (low + high).matrix();
  const Eigen::Vector3d right = Positive(solver.eigenvectors().col(2).normalized());
  Eigen::Vector3d up = Positive(solver.eigenvectors().col(0).normalized());
  if (normal_sum.dot(up) < 0) up = -up;
  view.axes.row(0) = right;
  view.axes.row(1) = right.cross(up).normalized();
  view.axes.row(2) = up;
  for (int i = 0; i < 3; ++i) {
    const auto bounds = TrimmedBounds(
        Positions(points_a, points_b, view.axes.row(i).transpose(), view.center), kBoundsTrim);
    view.low[i] = bounds[0];
    view.high[i] = bounds[1];
  }
  return view;
}

void TrimPlanView(const Points& points, double margin, PlanView* view) {
  for (int i = 0; i < 3; ++i) {
    const auto bounds = TrimmedBounds(
        Positions(points, {}, view->axes.row(i).transpose(), view->center), kCoreTrim);
    const double beyond = margin * (bounds[1] - bounds[0]);
    view->low[i] = std::max(view->low[i], bounds[0] - beyond);
    view->high[i] = std::min(view->high[i], bounds[1] + beyond);
  }
}

std::array<uint8_t, 3> RampColor(double share) {
  const double place = std::clamp(share, 0.0, 1.0);
  auto ramp = [place](double center) {
    return static_cast<uint8_t>(255 * std::clamp(1.5 - 4 * std::abs(place - center), 0.0, 1.0));
  };
  return {ramp(0.75), ramp(0.5), ramp(0.25)};
}

PlanPicture::PlanPicture(const PlanView& view, int width, int max_height) : view_(view) {
  const Eigen::Array3d extent = view.high - view.low;
  scale_ = (width - 1) / std::max(extent[0], std::numeric_limits<double>::min());
  if (!std::isfinite(scale_)) scale_ = 1;
  const double rows = std::clamp(scale_ * extent[1] + 1, 1.0, static_cast<double>(max_height));
  const int height = static_cast<int>(rows);
  picture_ = ColorImage(width, height, 3);
  top_ = FloatImage(width, height, 1, -std::numeric_limits<float>::infinity());
}

void PlanPicture::Add(const Eigen::Vector3d& xyz, const std::array<uint8_t, 3>& rgb) {
  const Eigen::Array3d place = view_.FromWorld(xyz).array() - view_.low;
  const double column = std::floor(scale_ * place[0]), row = std::floor(scale_ * place[1]);
  if (!(column >= 0 && row >= 0 && column < picture_.width && row < picture_.height)) return;
  const int x = static_cast<int>(column), y = static_cast<int>(row);
  const auto level = static_cast<float>(place[2]);
  if (level <= top_.At(x, y)) return;
  top_.At(x, y) = level;
  for (int c = 0; c < 3; ++c) picture_.At(x, y, c) = rgb[static_cast<size_t>(c)];
}

ColorImage StackPictures(const ColorImage& above, const ColorImage& below) {
  SEAPOINT_CHECK(above.width == below.width && above.channels == below.channels);
  ColorImage stack(above.width, above.height + kLineHeight + below.height, above.channels, 255);
  std::copy(above.data.begin(), above.data.end(), stack.data.begin());
  std::copy(below.data.begin(), below.data.end(), stack.Row(above.height + kLineHeight));
  return stack;
}

}  // namespace colmap_seapoint
