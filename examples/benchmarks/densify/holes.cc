#include "examples/benchmarks/densify/holes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/compare/plan_view.h"
#include "examples/benchmarks/densify/cloud_measures.h"
#include "examples/benchmarks/feature/pair_measures.h"

namespace colmap_seapoint {
namespace {

constexpr double kSpacingsPerCell = 3;
constexpr int kClosingRadius = 8, kFrayedRim = 2;  // cells
constexpr int kMargin = kClosingRadius + 2;        // cells around the bounds: closing needs them
constexpr double kBoundsSlack = 0.05;  // of the extent: the bounds leave out a thousandth
constexpr double kMaxCells = 4e8;
constexpr size_t kMaxSamples = 200000;

// The cloud on its plane. `height` is 0 where no point lies.
struct PlanGrid {
  PlanView view;
  Eigen::Array2d origin;  // right, down of the corner of cell (0, 0)
  double cell = 0;
  cv::Mat1b occupied;  // 255 where a point lies
  cv::Mat1f height;    // mean over the cell's points, along the view's up

  Eigen::Vector3d ToWorld(double column, double row, double up) const {
    const Eigen::Vector3d place(origin.x() + (column + 0.5) * cell, origin.y() + (row + 0.5) * cell,
                                up);
    return view.center + view.axes.transpose() * place;
  }
};

PlanView ViewOf(const std::vector<CloudPoint>& cloud) {
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d normal_sum = Eigen::Vector3d::Zero();
  for (const CloudPoint& point : cloud) {
    points.push_back(point.xyz.cast<double>());
    normal_sum += point.normal.cast<double>();
  }
  return FitPlanView(points, {}, normal_sum);
}

// The lowest point of the bounds lies in the middle of a cell.
PlanGrid MakeGrid(const std::vector<CloudPoint>& cloud, double cell) {
  PlanGrid grid;
  grid.view = ViewOf(cloud);
  grid.cell = cell;
  const Eigen::Array2d low = grid.view.low.head<2>(), high = grid.view.high.head<2>();
  const Eigen::Array2d margin = (kBoundsSlack * (high - low) / cell).ceil() + kMargin;
  const Eigen::Array2d size = ((high - low) / cell).ceil() + 2 * margin + 1;
  if (!(size.prod() <= kMaxCells)) {
    throw Error("the cloud", "is too large for cells of " + std::to_string(cell),
                "give a larger spacing");
  }
  grid.origin = low - (margin + 0.5) * cell;
  const cv::Size pixels(static_cast<int>(size.x()), static_cast<int>(size.y()));
  cv::Mat1f sum(pixels, 0), count(pixels, 0);
  for (const CloudPoint& point : cloud) {
    const Eigen::Vector3d place = grid.view.FromWorld(point.xyz.cast<double>());
    const Eigen::Array2d at = ((place.head<2>().array() - grid.origin) / cell).floor();
    if ((at < 0).any() || (at >= size).any()) continue;
    const cv::Point pixel(static_cast<int>(at.x()), static_cast<int>(at.y()));
    sum(pixel) += static_cast<float>(place.z());
    count(pixel) += 1;
  }
  grid.occupied = count > 0;
  cv::divide(sum, cv::max(count, 1), grid.height);
  return grid;
}

cv::Mat Disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
}

// The largest patch of the closed cells, filled.
cv::Mat1b OutlineOf(const cv::Mat1b& occupied) {
  cv::Mat1b closed, outline(occupied.size(), 0);
  cv::morphologyEx(occupied, closed, cv::MORPH_CLOSE, Disc(kClosingRadius));
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(closed, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  int best = -1;
  double best_area = -1;
  for (size_t i = 0; i < contours.size(); ++i) {
    const double area = cv::contourArea(contours[i]);
    if (area > best_area) best = static_cast<int>(i);
    best_area = std::max(best_area, area);
  }
  cv::drawContours(outline, contours, best, 255, cv::FILLED);
  return outline;
}

struct HoleSums {
  double num_cells = 0, column = 0, row = 0;
  double num_rim = 0, height = 0;  // of its cells' occupied neighbours

  void Add(const PlanGrid& grid, int x, int y) {
    ++num_cells;
    column += x;
    row += y;
    for (int j = y - 1; j <= y + 1; ++j) {
      for (int i = x - 1; i <= x + 1; ++i) {  // an inner cell has all its neighbours
        if (grid.occupied(j, i) == 0) continue;
        ++num_rim;
        height += grid.height(j, i);
      }
    }
  }
};

std::vector<Hole> ListHoles(const PlanGrid& grid, const cv::Mat1b& empty) {
  cv::Mat1i labels;
  const int num_labels = cv::connectedComponents(empty, labels, 8, CV_32S);
  std::vector<HoleSums> sums(static_cast<size_t>(num_labels));  // [0]: no hole
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      if (labels(y, x) > 0) sums[static_cast<size_t>(labels(y, x))].Add(grid, x, y);
    }
  }
  std::vector<Hole> holes;
  for (size_t i = 1; i < sums.size(); ++i) {
    const double column = sums[i].column / sums[i].num_cells, row = sums[i].row / sums[i].num_cells;
    const double up = sums[i].num_rim > 0 ? sums[i].height / sums[i].num_rim : 0;
    holes.push_back({sums[i].num_cells * grid.cell * grid.cell, grid.ToWorld(column, row, up),
                     static_cast<int>(std::lround(column)), static_cast<int>(std::lround(row))});
  }
  std::stable_sort(holes.begin(), holes.end(),
                   [](const Hole& a, const Hole& b) { return a.area > b.area; });
  return holes;
}

ColorImage Draw(const PlanGrid& grid, const cv::Mat1b& outline, const cv::Mat1b& empty) {
  ColorImage picture(outline.cols, outline.rows, 3);
  const double low = grid.view.low[2], relief = std::max(grid.view.high[2] - low, 1e-12);
  for (int y = 0; y < outline.rows; ++y) {
    for (int x = 0; x < outline.cols; ++x) {
      const double share = std::clamp((grid.height(y, x) - low) / relief, 0.0, 1.0);
      uint8_t gray = outline(y, x) > 0 ? 40 : 0;
      if (grid.occupied(y, x) > 0) gray = static_cast<uint8_t>(100 + 155 * share);
      for (int c = 0; c < 3; ++c) picture.At(x, y, c) = gray;
      if (empty(y, x) > 0) picture.At(x, y, 0) = 255;
    }
  }
  return picture;
}

}  // namespace

double MedianSpacing(const std::vector<CloudPoint>& cloud) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(cloud.size());
  for (const CloudPoint& point : cloud) points.push_back(point.xyz);
  const PointVector places = DistinctPlaces(points);
  if (places.size() < 2) {
    throw Error("the cloud", "has fewer than two places", "choose another one");
  }
  const PointIndex index(places);
  std::vector<double> distances;
  const size_t step = std::max<size_t>(1, places.size() / kMaxSamples);
  for (size_t i = 0; i < places.size(); i += step) {
    double squared = kBeyond;
    index.Nearest(places[i], NearestOf::kOtherPlace, &squared);
    distances.push_back(std::sqrt(squared));
  }
  return Median(distances);
}

HoleMap FindHoles(const std::vector<CloudPoint>& cloud, double spacing) {
  if (cloud.empty()) throw Error("the cloud", "is empty", "choose another one");
  const PlanGrid grid = MakeGrid(cloud, kSpacingsPerCell * spacing);
  const cv::Mat1b outline = OutlineOf(grid.occupied);
  cv::Mat1b inner;
  cv::erode(outline, inner, Disc(kFrayedRim));
  const cv::Mat1b empty = inner & ~grid.occupied;
  const double cell_area = grid.cell * grid.cell, num_inner = cv::countNonZero(inner);
  HoleMap map;
  map.spacing = spacing;
  map.cell = grid.cell;
  map.area = cell_area * cv::countNonZero(outline);
  map.occupied_area = cell_area * cv::countNonZero(outline & grid.occupied);
  map.hole_share = num_inner > 0 ? cv::countNonZero(empty) / num_inner : 0;
  map.holes = ListHoles(grid, empty);
  map.picture = Draw(grid, outline, empty);
  return map;
}

std::string HolesText(const HoleMap& map, size_t num_holes) {
  std::ostringstream text;
  text << "spacing " << map.spacing << ", cells of " << map.cell << "\narea inside the outline "
       << map.area << ", occupied " << map.occupied_area << "\nholes: " << std::fixed
       << std::setprecision(2) << 100 * map.hole_share << " % of the inner outline, "
       << map.holes.size() << " of them" << std::defaultfloat << std::setprecision(6) << '\n';
  if (num_holes == 0 || map.holes.empty()) return text.str();
  text << "area, share of the outline, centre x y z, column and row in the map:\n";
  for (size_t i = 0; i < std::min(num_holes, map.holes.size()); ++i) {
    const Hole& hole = map.holes[i];
    text << hole.area << "  " << std::fixed << std::setprecision(2) << 100 * hole.area / map.area
         << " %" << std::defaultfloat << std::setprecision(6) << "  " << hole.center.x() << ' '
         << hole.center.y() << ' ' << hole.center.z() << "  " << hole.column << ' ' << hole.row
         << '\n';
  }
  return text.str();
}

}  // namespace colmap_seapoint
