// Sparse symmetric matrices of 6 x 6 blocks, as the poses of pictures that see each other give, and
// their Cholesky factors.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

inline constexpr int kBlockSize = 6;
using Block = Eigen::Matrix<double, kBlockSize, kBlockSize>;

// The lower triangle by rows of blocks: those of row i are [row_begin[i], row_begin[i + 1]), their
// columns ascend and end with i itself. The whole blocks of the diagonal are stored.
struct BlockMatrix {
  std::vector<size_t> row_begin;
  std::vector<uint32_t> columns;
  std::vector<Block> blocks;

  size_t NumRows() const { return row_begin.size() - 1; }
  // The place of a block that the matrix has.
  size_t Find(uint32_t row, uint32_t column) const;
};

// The order of elimination (minimum degree) and the places of the factor's blocks are worked out
// once; then matrices of the same shape are factored as often as one likes. A column is computed by
// one thread, from the columns before it in a fixed order: the same bytes for any number of
// threads.
class BlockCholesky {
 public:
  explicit BlockCholesky(const BlockMatrix& shape);

  // Of matrix + diag(added). False when that is not positive definite.
  bool Factor(const BlockMatrix& matrix, const Eigen::VectorXd& added, int num_threads);
  // With the last factors.
  Eigen::VectorXd Solve(const Eigen::VectorXd& rhs) const;
  // The entry (index, index) of the inverse.
  double InverseDiagonal(Eigen::Index index) const;

  size_t NumFactorBlocks() const { return rows_.size(); }

 private:
  // A block of the factor in a row: which column, and its place there.
  struct RowEntry {
    uint32_t column;
    size_t place;
  };

  size_t NumColumns() const { return column_begin_.size() - 1; }
  void FindFactorShape(const BlockMatrix& shape);
  void ListRows();
  void ScatterMatrix(const BlockMatrix& matrix, const Eigen::VectorXd& added);
  bool FinishColumn(uint32_t j);
  void SubtractColumn(const RowEntry& entry, const std::vector<size_t>& place_of_row);
  void SolveLower(size_t first, Eigen::VectorXd* x) const;

  std::vector<uint32_t> position_;    // of each row of the matrix in the order of elimination
  std::vector<size_t> column_begin_;  // of the factor's columns in rows_ and factor_
  std::vector<uint32_t> rows_;        // ascending in a column, the diagonal first
  std::vector<Block> factor_;
  std::vector<size_t> row_entry_begin_;  // of the factor's rows in row_entries_
  std::vector<RowEntry> row_entries_;    // left of the diagonal, ascending by column
};

}  // namespace colmap_seapoint
