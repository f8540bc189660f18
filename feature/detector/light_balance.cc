#include "feature/detector/light_balance.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {

namespace {

constexpr int kCellsAcross = 28;

// The mean of the roots of the measures, by cell.
class UsualRoots {
 public:
  UsualRoots(const LocalMaxima& found, int width, int height)
      : cell_(std::max(16, std::max(width, height) / kCellsAcross)),
        nx_(width / cell_ + 1),
        ny_(height / cell_ + 1) {
    std::vector<double> sums(static_cast<size_t>(nx_ * ny_), 0), counts(sums.size(), 0);
    for (const LocalMaximum& maximum : found.maxima) {
      const size_t i = Index(maximum.x / cell_, maximum.y / cell_);
      const double root = std::sqrt(static_cast<double>(maximum.measure()));
      sums[i] += root;
      ++counts[i];
      mean_ += root / static_cast<double>(found.maxima.size());
    }
    Smooth(sums, counts);
  }

  double Mean() const { return mean_; }

  // Bilinear between the cells' centres; a maximum's own cell always holds one.
  double At(int x, int y) const {
    const double u = (x + 0.5) / cell_ - 0.5, v = (y + 0.5) / cell_ - 0.5;
    const int x0 = std::max(0, static_cast<int>(std::floor(u)));
    const int y0 = std::max(0, static_cast<int>(std::floor(v)));
    const int x1 = std::min(x0 + 1, nx_ - 1), y1 = std::min(y0 + 1, ny_ - 1);
    const double a = std::clamp(u - x0, 0.0, 1.0), b = std::clamp(v - y0, 0.0, 1.0);
    return (1 - b) * ((1 - a) * roots_[Index(x0, y0)] + a * roots_[Index(x1, y0)]) +
           b * ((1 - a) * roots_[Index(x0, y1)] + a * roots_[Index(x1, y1)]);
  }

 private:
  size_t Index(int i, int j) const { return static_cast<size_t>(j * nx_ + i); }

  // Weights 1 2 1 in both directions; the mean of all where no neighbour has a maximum.
  void Smooth(const std::vector<double>& sums, const std::vector<double>& counts) {
    roots_.assign(sums.size(), mean_);
    for (int j = 0; j < ny_; ++j) {
      for (int i = 0; i < nx_; ++i) {
        double sum = 0, count = 0;
        for (int v = std::max(0, j - 1); v <= std::min(ny_ - 1, j + 1); ++v) {
          for (int u = std::max(0, i - 1); u <= std::min(nx_ - 1, i + 1); ++u) {
            const double weight = (u == i ? 2 : 1) * (v == j ? 2 : 1);
            sum += weight * sums[Index(u, v)];
            count += weight * counts[Index(u, v)];
          }
        }
        if (count > 0) roots_[Index(i, j)] = sum / count;
      }
    }
  }

  const int cell_, nx_, ny_;
  double mean_ = 0;
  std::vector<double> roots_;
};

}  // namespace

std::vector<float> BalanceLight(const LocalMaxima& found, int width, int height, double strength) {
  std::vector<float> measures;
  measures.reserve(found.maxima.size());
  if (strength == 0) {
    for (const LocalMaximum& maximum : found.maxima) measures.push_back(maximum.measure());
    return measures;
  }
  const UsualRoots usual(found, width, height);
  for (const LocalMaximum& maximum : found.maxima) {
    const double relative = usual.At(maximum.x, maximum.y) / usual.Mean();
    measures.push_back(static_cast<float>(maximum.measure() / std::pow(relative, 2 * strength)));
  }
  return measures;
}

}  // namespace colmap_seapoint
