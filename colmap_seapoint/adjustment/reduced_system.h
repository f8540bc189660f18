// The second half of a linear problem: what is left for the poses and lenses when the points are
// eliminated, and the step that solves it.
//
// Poses are blocks of 6; a lens takes as many blocks as its free values need, the rest of the last
// one being held. So a lens is to the solver what a picture is that sees everything, and nothing is
// special about many lenses.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/adjustment/block_cholesky.h"
#include "colmap_seapoint/adjustment/equations/linearization.h"

namespace colmap_seapoint {

struct ReducedSystem {
  BlockMatrix matrix;              // rows: pictures, then each lens's blocks
  Eigen::VectorXd gradient;        // minus the right side
  Eigen::VectorXd diagonal;        // of the equations before the elimination: what damping goes by
  std::vector<uint32_t> lens_row;  // the first row of each lens, and the end

  Eigen::Index LensIndex(size_t lens) const {
    return static_cast<Eigen::Index>(kBlockSize * lens_row[lens]);
  }
};

// Its shape: two pictures have a block where they see a common point.
ReducedSystem MakeReducedSystem(const Bundle& bundle);

// Every picture's row is added up by one thread, in the order of its observations, and the lenses'
// in the order of the pictures: the same bytes for any number of threads. About 70 ns for every two
// observations of a point.
void Reduce(const Bundle& bundle, const BundleValues& values, const RobustLoss& loss,
            const Linearization& linearization, int num_threads, ReducedSystem* system);

// `values` with the poses and lenses moved by a step of the system's size; points stay.
BundleValues MovePosesAndLenses(const Bundle& bundle, const ReducedSystem& system,
                                const Eigen::VectorXd& step, const BundleValues& values);

// The step of one point that belongs to a step of the poses and lenses.
Eigen::Vector3d PointStep(const Bundle& bundle, const Linearization& linearization,
                          const ReducedSystem& system, const Eigen::VectorXd& step, size_t point);

}  // namespace colmap_seapoint
