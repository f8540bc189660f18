// Where points are, to the cell of a lattice: whether a further one adds anything (ours).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

// Cells of 21 bits a side around the origin: a survey of two million spacings.
class KnownPlaces {
 public:
  // `spacing`: of the points, world units.
  explicit KnownPlaces(double spacing) : spacing_(spacing) {}

  // Of a point that is known from the next Settle() on. Throws Error where it lies a million
  // spacings and more from the origin.
  void Add(const Eigen::Vector3d& place);
  // Sorts what was added to what is known. 8 bytes a cell.
  void Settle();
  // Whether a known point lies in the place's cell or one beside it: always within a spacing, never
  // beyond two along an axis.
  bool IsNear(const Eigen::Vector3d& place) const;

 private:
  bool Holds(const Eigen::Vector3i& cell) const;

  double spacing_;
  std::vector<uint64_t> cells_, added_;  // sorted, each once; not yet
  std::vector<uint64_t> regions_;        // of 16 cells a side: sorted, each once
};

}  // namespace colmap_seapoint
