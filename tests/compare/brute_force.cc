#include "tests/compare/brute_force.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <tuple>

namespace colmap_seapoint {
namespace {

using Key = std::tuple<double, double, double>;

double Squared(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
  return x * x + y * y + z * z;
}

std::vector<double> AllNearest(const PointVector& from, const PointVector& to) {
  std::vector<double> squared;
  for (const auto& a : from) {
    double least = INFINITY;
    for (const auto& b : to) least = std::min(least, Squared(a, b));
    squared.push_back(least);
  }
  return squared;
}

Key VoxelOf(const Eigen::Vector3d& xyz, double size, double shift) {
  return {std::floor(xyz.x() / size + shift), std::floor(xyz.y() / size + shift),
          std::floor(xyz.z() / size + shift)};
}

Key PlanCellOf(const Eigen::Vector3d& xyz, const PlanView& view, double size) {
  const Eigen::Vector3d place = view.FromWorld(xyz);
  return {std::floor(place.x() / size), std::floor(place.y() / size), 0};
}

// Shares within `distance`, by cell.
std::vector<double> CellShares(const std::vector<Key>& keys, const std::vector<double>& squared,
                               double distance) {
  std::map<Key, std::pair<double, double>> cells;
  for (size_t i = 0; i < keys.size(); ++i) {
    cells[keys[i]].first += squared[i] <= distance * distance;
    cells[keys[i]].second += 1;
  }
  std::vector<double> shares;
  for (const auto& item : cells) shares.push_back(item.second.first / item.second.second);
  return shares;
}

PointVector Reduced(const PointVector& points, double size) {
  std::map<Key, std::pair<Eigen::Vector3d, int>> voxels;
  for (const auto& xyz : points) {
    auto& voxel =
        voxels.try_emplace(VoxelOf(xyz, size, 0), Eigen::Vector3d::Zero(), 0).first->second;
    voxel.first += xyz;
    voxel.second += 1;
  }
  PointVector reduced;
  for (const auto& item : voxels) reduced.push_back(item.second.first / item.second.second);
  return reduced;
}

double Sum(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

OneWay Compare(const PointVector& from, const PointVector& to, const CloudComparison& setup,
               const PlanView& view) {
  OneWay way;
  way.num_points = from.size();
  way.spacing = SpacingByBruteForce(from);
  std::vector<double> squared = AllNearest(from, to);
  double sum = 0, sum_squared = 0, num_near = 0;
  for (double& value : squared) {
    if (value > setup.max_distance * setup.max_distance) {
      value = INFINITY;
      ++way.num_beyond;
      continue;
    }
    sum += std::sqrt(value);
    sum_squared += value;
    num_near += 1;
  }
  way.mean = sum / num_near;
  way.rms = std::sqrt(sum_squared / num_near);
  std::vector<double> sorted = squared;
  std::sort(sorted.begin(), sorted.end());
  way.median = std::sqrt(sorted[(sorted.size() - 1) / 2]);

  std::vector<Key> voxels[2], area, cells;
  for (const auto& xyz : from) {
    voxels[0].push_back(VoxelOf(xyz, setup.voxel_size, 0));
    voxels[1].push_back(VoxelOf(xyz, setup.voxel_size, 0.5));
    area.push_back(PlanCellOf(xyz, view, setup.area_cell_size));
    cells.push_back(PlanCellOf(xyz, view, setup.cell_size));
  }
  way.num_cells = std::set<Key>(cells.begin(), cells.end()).size();
  way.num_area_cells = std::set<Key>(area.begin(), area.end()).size();
  const double cell_area = setup.area_cell_size * setup.area_cell_size;
  way.area = cell_area * static_cast<double>(way.num_area_cells);
  for (const double distance : setup.distances) {
    DistanceShares at;
    for (const double value : squared) at.num_within += value <= distance * distance;
    const auto shares0 = CellShares(voxels[0], squared, distance);
    const auto shares1 = CellShares(voxels[1], squared, distance);
    way.num_voxels = shares0.size() + shares1.size();
    at.voxel_share = (Sum(shares0) + Sum(shares1)) / static_cast<double>(way.num_voxels);
    at.far_area = cell_area * (static_cast<double>(way.num_area_cells) -
                               Sum(CellShares(area, squared, distance)));
    const PointVector own = Reduced(from, 0.5 * distance);
    at.num_reduced = own.size();
    for (const double value : AllNearest(own, Reduced(to, 0.5 * distance))) {
      at.num_reduced_within += value < distance * distance;
    }
    way.at.push_back(at);
  }
  return way;
}

template <typename T>
void WritePly(const std::filesystem::path& path, const PointVector& points, const char* type) {
  std::ofstream stream(path, std::ios::binary);
  stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size();
  for (const char* name : {"x", "y", "z"}) stream << "\nproperty " << type << " " << name;
  stream << "\nend_header\n";
  for (const auto& xyz : points) {
    const Eigen::Matrix<T, 3, 1> value = xyz.cast<T>();
    stream.write(reinterpret_cast<const char*>(value.data()), 3 * sizeof(T));
  }
}

}  // namespace

double SpacingByBruteForce(const PointVector& cloud) {
  std::vector<double> squared;
  for (const auto& a : cloud) {
    double least = INFINITY;
    for (const auto& b : cloud) {
      const double value = Squared(a, b);
      if (value > 0) least = std::min(least, value);
    }
    squared.push_back(least);
  }
  std::sort(squared.begin(), squared.end());
  const double median = squared[(squared.size() - 1) / 2];
  return std::isfinite(median) ? std::sqrt(median) : 0;
}

CloudComparison CompareByBruteForce(const PointVector& input, const PointVector& reference,
                                    const CloudComparison& setup, const PlanView& view) {
  CloudComparison result = setup;
  result.input = Compare(input, reference, setup, view);
  result.reference = Compare(reference, input, setup, view);
  return result;
}

void WriteDoublePly(const std::filesystem::path& path, const PointVector& points) {
  WritePly<double>(path, points, "double");
}

void WriteFloatPly(const std::filesystem::path& path, const PointVector& points) {
  WritePly<float>(path, points, "float");
}

}  // namespace colmap_seapoint
