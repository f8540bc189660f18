#include "examples/survey/scene/noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace colmap_seapoint {
namespace {

constexpr double kLacunarity = 2.13;       // no integer: the lattices of the octaves never line up
constexpr float kNoiseDeviation = 0.266f;  // of one octave with amplitude 1

struct Gradient {
  float x, y;
};

Gradient GradientAt(uint64_t seed, int64_t i, int64_t j) {
  const float angle = static_cast<float>(Hash(seed, i, j) >> 40) * (6.2831853f / 16777216.0f);
  return {std::cos(angle), std::sin(angle)};
}

float Fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

// The places at which the nodes of one axis fall in the lattice.
struct Axis {
  std::vector<int> cell;  // relative to first_cell
  std::vector<float> fraction;
  std::vector<float> weight;
  int64_t first_cell = 0;
  int num_cells = 0;

  Axis(int64_t i0, int n, double step, double wavelength, double offset) {
    for (int i = 0; i < n; ++i) {
      const double position = static_cast<double>(i0 + i) * step / wavelength + offset;
      const double floor = std::floor(position);
      if (i == 0) first_cell = static_cast<int64_t>(floor);
      cell.push_back(static_cast<int>(static_cast<int64_t>(floor) - first_cell));
      fraction.push_back(static_cast<float>(position - floor));
      weight.push_back(Fade(fraction.back()));
    }
    num_cells = cell.back() + 1;
  }
};

std::vector<Gradient> MakeLattice(const Axis& x, const Axis& y, uint64_t seed) {
  std::vector<Gradient> lattice;
  lattice.reserve(static_cast<size_t>(x.num_cells + 1) * static_cast<size_t>(y.num_cells + 1));
  for (int j = 0; j <= y.num_cells; ++j) {
    for (int i = 0; i <= x.num_cells; ++i) {
      lattice.push_back(GradientAt(seed, x.first_cell + i, y.first_cell + j));
    }
  }
  return lattice;
}

// Along a row the noise of a lattice column is a line over the fraction: constant + slope * fx.
struct Line {
  float constant, slope;
};

Line ColumnLine(const Gradient& top, const Gradient& bottom, float fy, float wy) {
  return {Mix(top.y * fy, bottom.y * (fy - 1), wy), Mix(top.x, bottom.x, wy)};
}

void AddRow(const Axis& x, const Gradient* top, const Gradient* bottom, float fy, float wy,
            float amplitude, float* row) {
  const int n = static_cast<int>(x.cell.size());
  for (int begin = 0; begin < n;) {
    const int cell = x.cell[static_cast<size_t>(begin)];
    int end = begin + 1;
    while (end < n && x.cell[static_cast<size_t>(end)] == cell) ++end;
    const Line left = ColumnLine(top[cell], bottom[cell], fy, wy);
    const Line right = ColumnLine(top[cell + 1], bottom[cell + 1], fy, wy);
    const float* fraction = x.fraction.data();
    const float* weight = x.weight.data();
    for (int i = begin; i < end; ++i) {
      const float a = left.constant + left.slope * fraction[i];
      const float b = right.constant + right.slope * (fraction[i] - 1);
      row[i] += amplitude * (a + weight[i] * (b - a));
    }
    begin = end;
  }
}

}  // namespace

void AddNoise(const GridSpec& grid, double wavelength, float amplitude, uint64_t seed,
              Field* field) {
  const Axis x(grid.ix0, grid.nx, grid.step, wavelength, Uniform(Hash(seed, 1)));
  const Axis y(grid.iy0, grid.ny, grid.step, wavelength, Uniform(Hash(seed, 2)));
  const std::vector<Gradient> lattice = MakeLattice(x, y, seed);
  for (int j = 0; j < grid.ny; ++j) {
    const size_t row = static_cast<size_t>(j);
    const Gradient* top =
        lattice.data() + static_cast<size_t>(y.cell[row]) * static_cast<size_t>(x.num_cells + 1);
    AddRow(x, top, top + x.num_cells + 1, y.fraction[row], y.weight[row], amplitude,
           field->data() + row * static_cast<size_t>(grid.nx));
  }
}

Field MakeFbm(const GridSpec& grid, const Fbm& fbm, uint64_t seed) {
  std::vector<std::pair<double, float>> octaves;
  float amplitude = 1, energy = 0;
  for (double wavelength = fbm.longest; wavelength >= 0.99 * fbm.shortest || octaves.empty();
       wavelength /= kLacunarity) {
    octaves.emplace_back(wavelength, amplitude);
    energy += amplitude * amplitude;
    amplitude *= fbm.persistence;
  }
  const float scale = 1 / (kNoiseDeviation * std::sqrt(energy));
  Field field(grid.Size(), 0.0f);
  for (size_t k = 0; k < octaves.size(); ++k) {
    AddNoise(grid, octaves[k].first, scale * octaves[k].second, Hash(seed, static_cast<int64_t>(k)),
             &field);
  }
  return field;
}

float NoiseAt(double x, double y, double wavelength, uint64_t seed) {
  const double px = x / wavelength, py = y / wavelength;
  const int64_t i = static_cast<int64_t>(std::floor(px)), j = static_cast<int64_t>(std::floor(py));
  const float fx = static_cast<float>(px - std::floor(px));
  const float fy = static_cast<float>(py - std::floor(py));
  const float wy = Fade(fy);
  const Line left = ColumnLine(GradientAt(seed, i, j), GradientAt(seed, i, j + 1), fy, wy);
  const Line right = ColumnLine(GradientAt(seed, i + 1, j), GradientAt(seed, i + 1, j + 1), fy, wy);
  return Mix(left.constant + left.slope * fx, right.constant + right.slope * (fx - 1), Fade(fx));
}

}  // namespace colmap_seapoint
