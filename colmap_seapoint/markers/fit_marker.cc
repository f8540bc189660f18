#include "colmap_seapoint/markers/fit_marker.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "colmap_seapoint/markers/marker_codes.h"

namespace colmap_seapoint {
namespace {

constexpr double kReach = 0.35;       // cells around the square that are compared
constexpr double kEdgeReach = 4;      // pixels around the cells' edges that tell where these lie
constexpr uint32_t kFlatPixels = 16;  // of those between them, one in so many
constexpr double kMaxPixels = 12000;  // of one marker, about
constexpr double kFirstBlur = 0.7;    // standard deviation, pixels
constexpr double kMinBlur = 0.25;     // of the pixels themselves
constexpr int kMaxSteps = 25;
constexpr double kConverged = 1e-4;    // pixels
constexpr double kMaxMove = 2.5;       // of a corner, pixels
constexpr double kMaxResidual = 0.15;  // root mean square, of the contrast

// Where a pixel lies on the print: homogeneous, the last of the nine numbers being 1.
constexpr int kPlaceParams = 8;
enum Param {
  kBlack = kPlaceParams,
  kWhite,
  kAround,  // what lies around the print: 0 as black ... 1 as white
  kGradientX,
  kGradientY,
  kTone,
  kBlur,
  kNumParams
};
using Params = Eigen::Matrix<double, kNumParams, 1>;
using Normal = Eigen::Matrix<double, kNumParams, kNumParams>;

double Linear(uint8_t value) {
  const double v = value / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double Density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI); }
double Distribution(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// How much of each column (or row) of cells a blurred look at `u` sees, and the derivatives by u
// and by the blur: from the margin's on, which is one cell wide, to that at the other side. The
// last one is the sum of all.
struct CellShares {
  static constexpr size_t kMost = 12;
  std::array<double, kMost> share{}, by_u{}, by_blur{};

  CellShares(double u, double blur, int num_cells) {
    const Edge first((-1 - u) / blur, blur);
    Edge before = first;
    for (int k = 0; k <= num_cells + 1; ++k) {
      const Edge after((k - u) / blur, blur);
      Set(static_cast<size_t>(k), before, after);
      before = after;
    }
    Set(static_cast<size_t>(num_cells + 2), first, before);
  }

 private:
  struct Edge {
    double passed, by_u, by_blur;
    Edge(double z, double blur)
        : passed(Distribution(z)), by_u(-Density(z) / blur), by_blur(-z * Density(z) / blur) {}
  };

  void Set(size_t i, const Edge& before, const Edge& after) {
    share[i] = after.passed - before.passed;
    by_u[i] = after.by_u - before.by_u;
    by_blur[i] = after.by_blur - before.by_blur;
  }
};

// The white share of the print around a place, 0 to 1, and its derivatives.
struct Shade {
  double white = 0, by_u = 0, by_v = 0, by_blur = 0;
  double around = 0;  // the share of what is beyond the margin
};

class Print {
 public:
  explicit Print(const MarkerName& name) : cells_(NumCells(name.family)) {
    for (int row = -1; row <= cells_; ++row) {
      for (int column = -1; column <= cells_; ++column) {
        white_.push_back(IsWhiteCell(name, column, row) ? 1 : 0);
      }
    }
  }

  int NumCellsOfSide() const { return cells_; }

  // `blur`: along u and v, cells; `around`: how white it is beyond the margin.
  Shade At(double u, double v, const Eigen::Vector2d& blur, double around) const {
    const CellShares columns(u, blur.x(), cells_), rows(v, blur.y(), cells_);
    const auto n = static_cast<size_t>(cells_ + 2);
    Shade shade;
    const auto add = [&](double factor, size_t column, size_t row) {
      const double share = columns.share[column] * rows.share[row];
      shade.white += factor * share;
      shade.by_u += factor * columns.by_u[column] * rows.share[row];
      shade.by_v += factor * columns.share[column] * rows.by_u[row];
      // By the factor that multiplies both blurs.
      shade.by_blur += factor * (columns.by_blur[column] * rows.share[row] * blur.x() +
                                 columns.share[column] * rows.by_blur[row] * blur.y());
    };
    for (size_t row = 0; row < n; ++row) {
      for (size_t column = 0; column < n; ++column) {
        if (white_[row * n + column] != 0) add(1, column, row);
      }
    }
    add(-around, n, n);
    shade.white += around;
    shade.around = 1 - columns.share[n] * rows.share[n];
    return shade;
  }

 private:
  int cells_;
  std::vector<char> white_;  // row by row, with the margin
};

struct Pixel {
  Eigen::Vector2d place;  // from the marker's centre
  double value = 0;       // linear light
};

// The homography that takes the corners to those of the print.
Eigen::Matrix3d PrintFromPixel(const std::array<Eigen::Vector2d, 4>& corners,
                               const std::array<Eigen::Vector2d, 4>& on_print) {
  Eigen::Matrix<double, 8, 8> equations;
  Eigen::Matrix<double, 8, 1> right;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d &p = corners[static_cast<size_t>(k)],
                          &q = on_print[static_cast<size_t>(k)];
    equations.row(2 * k) << p.x(), p.y(), 1, 0, 0, 0, -p.x() * q.x(), -p.y() * q.x();
    equations.row(2 * k + 1) << 0, 0, 0, p.x(), p.y(), 1, -p.x() * q.y(), -p.y() * q.y();
    right.segment<2>(2 * k) = q;
  }
  const Eigen::Matrix<double, 8, 1> h = equations.fullPivLu().solve(right);
  Eigen::Matrix3d matrix;
  matrix << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  return matrix;
}

Eigen::Matrix3d PlaceOf(const Params& params) {
  Eigen::Matrix3d matrix;
  matrix << params[0], params[1], params[2], params[3], params[4], params[5], params[6], params[7],
      1;
  return matrix;
}

// As the library has them: it reads the bits of a print with these corners.
std::array<Eigen::Vector2d, 4> CornersOfPrint(int cells) {
  const double n = cells;
  return {{{0, n}, {n, n}, {n, 0}, {0, 0}}};
}

// Pixels a cell, along u and v, in the middle of the marker.
Eigen::Vector2d CellSize(const std::array<Eigen::Vector2d, 4>& corners, int cells) {
  const double across = (corners[1] - corners[0]).norm() + (corners[2] - corners[3]).norm();
  const double along = (corners[0] - corners[3]).norm() + (corners[1] - corners[2]).norm();
  return Eigen::Vector2d(across, along) / (2.0 * cells);
}

// A raster would pass over edges that lie along it.
uint32_t Scattered(int x, int y) {
  uint32_t bits = static_cast<uint32_t>(x) * 0x9e3779b1u ^ static_cast<uint32_t>(y) * 0x85ebca77u;
  bits = (bits ^ bits >> 15) * 0x2c1b3c6du;
  return bits ^ bits >> 13;
}

std::vector<Pixel> PixelsOf(const GrayImage& picture, const Eigen::Vector2d& centre,
                            const Eigen::Matrix3d& print_from_pixel,
                            const std::array<Eigen::Vector2d, 4>& corners, int cells) {
  Eigen::Array2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const Eigen::Vector2d& corner : corners) {
    low = low.min(corner.array());
    high = high.max(corner.array());
  }
  const double margin = 2 + (high - low).maxCoeff() * kReach / cells;
  const Eigen::Vector2d near_edge = kEdgeReach * CellSize(corners, cells).cwiseInverse();
  const double edge_share = std::min(1.0, 2 * near_edge.sum());
  const auto thinning =
      static_cast<uint32_t>(std::max(1.0, edge_share * (high - low).prod() / kMaxPixels));
  std::vector<Pixel> pixels;
  const auto bounds = [&](double from, double to, double shift, int size) {
    return std::pair(std::max(0, static_cast<int>(std::floor(from - margin + shift))),
                     std::min(size - 1, static_cast<int>(std::ceil(to + margin + shift))));
  };
  const auto [x0, x1] = bounds(low.x(), high.x(), centre.x(), picture.width);
  const auto [y0, y1] = bounds(low.y(), high.y(), centre.y(), picture.height);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d place(x + 0.5 - centre.x(), y + 0.5 - centre.y());
      const Eigen::Vector2d print = (print_from_pixel * place.homogeneous()).hnormalized();
      if (print.minCoeff() < -kReach || print.maxCoeff() > cells + kReach) continue;
      const Eigen::Array2d off_edge = (print.array() - print.array().round()).abs();
      const bool is_flat = (off_edge > near_edge.array()).all();
      if (Scattered(x, y) % (is_flat ? kFlatPixels * thinning : thinning) != 0) continue;
      pixels.push_back({place, Linear(picture.At(x, y))});
    }
  }
  return pixels;
}

// What a pixel should show, and the derivatives by all unknowns.
double Predict(const Print& print, const Params& params, const Eigen::Vector2d& cell,
               const Eigen::Vector2d& place, Params* derivative) {
  const double w = params[6] * place.x() + params[7] * place.y() + 1;
  const double u = (params[0] * place.x() + params[1] * place.y() + params[2]) / w;
  const double v = (params[3] * place.x() + params[4] * place.y() + params[5]) / w;
  const double blur = std::exp(params[kBlur]);
  const Shade shade = print.At(u, v, blur * cell.cwiseInverse(), params[kAround]);
  const double middle = 0.5 * print.NumCellsOfSide(), p = shade.white;
  const double light = 1 + params[kGradientX] * (u - middle) + params[kGradientY] * (v - middle);
  const double tone = p + params[kTone] * p * (1 - p);
  const double contrast = params[kWhite] - params[kBlack];
  const double by_shade = light * contrast * (1 + params[kTone] * (1 - 2 * p));
  const double bare = params[kBlack] + contrast * tone;
  const double by_u = by_shade * shade.by_u + bare * params[kGradientX];
  const double by_v = by_shade * shade.by_v + bare * params[kGradientY];
  const Eigen::Vector3d by_line(place.x() / w, place.y() / w, 1 / w);
  derivative->segment<3>(0) = by_u * by_line;
  derivative->segment<3>(3) = by_v * by_line;
  derivative->segment<2>(6) = -(by_u * u + by_v * v) * by_line.head<2>();
  (*derivative)[kBlack] = light * (1 - tone);
  (*derivative)[kWhite] = light * tone;
  (*derivative)[kAround] = by_shade * shade.around;
  (*derivative)[kGradientX] = bare * (u - middle);
  (*derivative)[kGradientY] = bare * (v - middle);
  (*derivative)[kTone] = light * contrast * p * (1 - p);
  (*derivative)[kBlur] = by_shade * shade.by_blur;
  return light * bare;
}

// Least squares by Levenberg and Marquardt.
class Fit {
 public:
  Fit(const Print& print, const Eigen::Vector2d& cell, const std::vector<Pixel>& pixels)
      : print_(print), cell_(cell), pixels_(pixels) {}

  // The sum of the squared residuals.
  double Run(Params* params) const {
    double damping = 1e-3;
    Equations here = Linearise(*params);
    for (int step = 0; step < kMaxSteps && damping < 1e6; ++step) {
      Normal normal = here.normal;
      normal.diagonal() *= 1 + damping;
      normal.diagonal().array() += 1e-12;
      Params moved = *params + normal.ldlt().solve(here.right);
      moved[kTone] = std::clamp(moved[kTone], -0.95, 0.95);
      moved[kBlur] = std::clamp(moved[kBlur], std::log(kMinBlur), std::log(cell_.minCoeff()));
      const Equations there = Linearise(moved);
      if (!(there.cost < here.cost)) {
        damping *= 10;
        continue;
      }
      const bool is_done = here.cost - there.cost < kConverged * here.cost;
      *params = moved;
      here = there;
      damping *= 0.1;
      if (is_done) break;
    }
    return here.cost;
  }

 private:
  struct Equations {
    Normal normal = Normal::Zero();
    Params right = Params::Zero();
    double cost = 0;
  };

  Equations Linearise(const Params& params) const {
    Equations sum;
    Params derivative;
    for (const Pixel& pixel : pixels_) {
      const double residual =
          pixel.value - Predict(print_, params, cell_, pixel.place, &derivative);
      sum.normal.selfadjointView<Eigen::Lower>().rankUpdate(derivative);
      sum.right += residual * derivative;
      sum.cost += residual * residual;
    }
    sum.normal = sum.normal.selfadjointView<Eigen::Lower>();
    return sum;
  }

  const Print& print_;
  const Eigen::Vector2d cell_;  // pixels
  const std::vector<Pixel>& pixels_;
};

Params FirstParams(const Eigen::Matrix3d& place, const std::vector<Pixel>& pixels) {
  std::vector<double> values;
  for (const Pixel& pixel : pixels) values.push_back(pixel.value);
  std::sort(values.begin(), values.end());
  Params params = Params::Zero();
  params.head<kPlaceParams>() << place(0, 0), place(0, 1), place(0, 2), place(1, 0), place(1, 1),
      place(1, 2), place(2, 0), place(2, 1);
  params[kBlack] = values[values.size() / 20];
  params[kWhite] = values[values.size() - 1 - values.size() / 20];
  params[kAround] = 0.5;
  params[kBlur] = std::log(kFirstBlur);
  return params;
}

}  // namespace

std::optional<std::array<Eigen::Vector2d, 4>> FitCorners(const GrayImage& picture,
                                                         const DetectedMarker& marker) {
  if (marker.is_mirrored) return std::nullopt;
  const Print print(marker.name);
  const int cells = print.NumCellsOfSide();
  const Eigen::Vector2d centre = marker.Centre();
  if (!centre.allFinite()) return std::nullopt;
  std::array<Eigen::Vector2d, 4> corners = marker.corners;
  for (Eigen::Vector2d& corner : corners) corner -= centre;
  const auto on_print = CornersOfPrint(cells);
  const Eigen::Matrix3d place = PrintFromPixel(corners, on_print);
  const auto pixels = PixelsOf(picture, centre, place, corners, cells);
  if (!place.allFinite() || pixels.size() < 4 * kNumParams) return std::nullopt;
  Params params = FirstParams(place, pixels);
  const double cost = Fit(print, CellSize(corners, cells), pixels).Run(&params);
  const double residual = std::sqrt(cost / static_cast<double>(pixels.size()));
  if (!(residual < kMaxResidual * std::abs(params[kWhite] - params[kBlack]))) return std::nullopt;
  const Eigen::Matrix3d pixel_from_print = PlaceOf(params).inverse();
  for (size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d fitted = (pixel_from_print * on_print[k].homogeneous()).hnormalized();
    if (!((fitted - corners[k]).norm() < kMaxMove)) return std::nullopt;
    corners[k] = fitted + centre;
  }
  return corners;
}

}  // namespace colmap_seapoint
