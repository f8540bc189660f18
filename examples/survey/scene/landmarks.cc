#include "examples/survey/scene/landmarks.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Radius (of the largest) and height (of the whole) along the statue's outline, from its foot.
constexpr double kOutline[][2] = {{1.0, -0.25}, {1.0, 0.14},  {0.62, 0.15}, {0.66, 0.30},
                                  {0.42, 0.48}, {0.46, 0.54}, {0.98, 0.60}, {0.90, 0.70},
                                  {0.30, 0.75}, {0.27, 0.80}, {0.55, 0.84}, {0.60, 0.91},
                                  {0.42, 0.98}, {0.02, 1.0}};

// The outline as a curve by its length, its corners rounded.
class Outline {
 public:
  explicit Outline(const LandmarkOptions& options) : rounding_(0.03 * options.height) {
    for (const auto& [r, z] : kOutline) {
      corners_.emplace_back(r * options.radius, z * options.height);
      length_.push_back(corners_.size() == 1
                            ? 0
                            : length_.back() +
                                  (corners_.back() - corners_[corners_.size() - 2]).norm());
    }
  }
  double Length() const { return length_.back(); }

  // (radius, height) at `s` metres from the foot: the mean over a short way.
  Eigen::Vector2d At(double s) const {
    constexpr int kSteps = 8;
    const double reach = std::min({rounding_, s, Length() - s});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = 0; k <= kSteps; ++k) sum += Corner(s + reach * (2.0 * k / kSteps - 1));
    return sum / (kSteps + 1);
  }
  // Unit, outwards.
  Eigen::Vector2d Normal(double s) const {
    const double h = 0.5 * rounding_;
    const Eigen::Vector2d way = At(std::min(s + h, Length())) - At(std::max(s - h, 0.0));
    return Eigen::Vector2d(way.y(), -way.x()).normalized();
  }

 private:
  Eigen::Vector2d Corner(double s) const {
    size_t k = 1;
    while (k + 1 < length_.size() && length_[k] < s) ++k;
    const double part = (s - length_[k - 1]) / (length_[k] - length_[k - 1]);
    return corners_[k - 1] + part * (corners_[k] - corners_[k - 1]);
  }

  double rounding_;
  std::vector<Eigen::Vector2d> corners_;
  std::vector<double> length_;
};

// Noise of deviation 1 on the lattice; its last columns run into the first one.
Field ClosedNoise(const GridSpec& grid, const Fbm& fbm, uint64_t seed) {
  GridSpec longer = grid;
  const int overlap = std::max(1, grid.nx / 8);
  longer.nx += overlap;
  const Field noise = MakeFbm(longer, fbm, seed);
  Field closed(grid.Size());
  for (int j = 0; j < grid.ny; ++j) {
    const float* from = noise.data() + static_cast<size_t>(j) * static_cast<size_t>(longer.nx);
    float* to = closed.data() + static_cast<size_t>(j) * static_cast<size_t>(grid.nx);
    for (int i = 0; i < grid.nx; ++i) {
      // The first columns begin as what comes behind the last one.
      const int period = grid.nx - 1;
      const float weight = std::min(1.0f, static_cast<float>(i) / static_cast<float>(overlap));
      to[i] = i < overlap ? Mix(from[i + period], from[i], weight) : from[i];
    }
    to[grid.nx - 1] = to[0];
  }
  return closed;
}

}  // namespace

HeightField WithBoulder(const HeightField& ground, const LandmarkOptions& options) {
  const GridSpec& grid = ground.Grid();
  const double finest = std::max(0.008, 3 * options.cell);
  const Field rough = MakeFbm(grid, {0.9, finest, 0.5f}, Hash(options.seed, 101));
  const double base = ground.Height(0, 0);
  Field heights = ground.Heights();
  for (int j = 0; j < grid.ny; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      const size_t n =
          static_cast<size_t>(j) * static_cast<size_t>(grid.nx) + static_cast<size_t>(i);
      const double factor = 1 + 0.12 * options.relief * static_cast<double>(rough[n]);
      const double q = (grid.X(i) * grid.X(i) + 1.3 * grid.Y(j) * grid.Y(j)) /
                       (options.radius * options.radius) * std::clamp(factor, 0.6, 1.6);
      if (q >= 1) continue;
      // No steeper than two to one: colours lie on the plan, and would be drawn out on its sides.
      const double bump =
          options.height * (1 - q) * (1 + 0.03 * options.relief * static_cast<double>(rough[n]));
      heights[n] = std::max(heights[n], static_cast<float>(base + bump));
    }
  }
  return HeightField(grid, std::move(heights));
}

Sheet MakeStatue(const LandmarkOptions& options, double ground_height) {
  const Outline outline(options);
  const double around = 2 * kPi * 0.65 * options.radius;  // at the mean radius
  GridSpec grid;
  grid.step = options.cell;
  grid.nx = static_cast<int>(std::ceil(around / grid.step)) + 1;
  grid.ny = static_cast<int>(std::floor(outline.Length() / grid.step)) + 1;
  const double finest = std::max(0.008, 3 * options.cell);
  const Field rough = ClosedNoise(grid, {0.3, finest, 0.5f}, Hash(options.seed, 102));
  std::vector<Eigen::Vector3f> nodes;
  nodes.reserve(grid.Size());
  for (int j = 0; j < grid.ny; ++j) {
    const double s = outline.Length() * j / (grid.ny - 1);
    const Eigen::Vector2d place = outline.At(s), normal = outline.Normal(s);
    for (int i = 0; i < grid.nx; ++i) {
      const double angle = 2 * kPi * (i % (grid.nx - 1)) / (grid.nx - 1);
      const double turn = angle + 1.5 * place.y() / options.height;  // the body twists upwards
      const double shape = 1 + 0.16 * std::cos(2 * turn) + 0.07 * std::cos(3 * turn + 1);
      const double bump =
          0.008 * options.relief *
          static_cast<double>(rough[static_cast<size_t>(j) * static_cast<size_t>(grid.nx) +
                                    static_cast<size_t>(i)]);
      // The pole on the head stays one place.
      const double near_pole = std::min(1.0, place.x() / (0.1 * options.radius));
      const double radius = std::max(0.0, shape * place.x() + near_pole * bump * normal.x());
      nodes.emplace_back(Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle),
                                         ground_height + place.y() + near_pole * bump * normal.y())
                             .cast<float>());
    }
  }
  return Sheet(grid.nx, grid.ny, std::move(nodes), grid.step);
}

}  // namespace colmap_seapoint
