// A sparse matrix of blocks as a dense one, for what the tests compare with.
#pragma once

#include <Eigen/Core>

#include "colmap_seapoint/adjustment/block_cholesky.h"

namespace colmap_seapoint {

inline Eigen::MatrixXd Dense(const BlockMatrix& matrix) {
  const auto size = static_cast<Eigen::Index>(kBlockSize * matrix.NumRows());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
  for (size_t i = 0; i < matrix.NumRows(); ++i) {
    for (size_t k = matrix.row_begin[i]; k < matrix.row_begin[i + 1]; ++k) {
      const auto row = static_cast<Eigen::Index>(kBlockSize * i);
      const Eigen::Index column = kBlockSize * matrix.columns[k];
      dense.block<kBlockSize, kBlockSize>(row, column) = matrix.blocks[k];
      dense.block<kBlockSize, kBlockSize>(column, row) = matrix.blocks[k].transpose();
    }
  }
  return dense;
}

}  // namespace colmap_seapoint
