#include "colmap_seapoint/adjustment/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <numeric>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

// Which position in the order of elimination each row has.
std::vector<uint32_t> MinimumDegreePositions(const BlockMatrix& shape) {
  const auto size = static_cast<int>(shape.NumRows());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i) {
    for (size_t k = shape.row_begin[static_cast<size_t>(i)];
         k < shape.row_begin[static_cast<size_t>(i) + 1]; ++k) {
      entries.emplace_back(i, static_cast<int>(shape.columns[k]), 1);
    }
  }
  Eigen::SparseMatrix<double> lower(size, size);
  lower.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(lower, order);
  std::vector<uint32_t> positions(static_cast<size_t>(size));
  for (int k = 0; k < size; ++k) {
    positions[static_cast<size_t>(order.indices()[k])] = static_cast<uint32_t>(k);
  }
  return positions;
}

// Which columns are finished. Threads take columns in ascending order and wait here for those that
// they need: the smallest unfinished one needs none, so that somebody always goes on.
class FinishedColumns {
 public:
  explicit FinishedColumns(size_t count) : is_finished_(count) {}

  void Finish(size_t column) {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_finished_[column].store(true, std::memory_order_release);
    changed_.notify_all();
  }
  void WaitFor(size_t column) {
    if (is_finished_[column].load(std::memory_order_acquire)) return;
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return is_finished_[column].load(std::memory_order_relaxed); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::atomic<bool>> is_finished_;
};

}  // namespace

size_t BlockMatrix::Find(uint32_t row, uint32_t column) const {
  const auto begin = columns.begin() + static_cast<std::ptrdiff_t>(row_begin[row]);
  const auto end = columns.begin() + static_cast<std::ptrdiff_t>(row_begin[row + 1]);
  return static_cast<size_t>(std::lower_bound(begin, end, column) - columns.begin());
}

BlockCholesky::BlockCholesky(const BlockMatrix& shape) : position_(MinimumDegreePositions(shape)) {
  FindFactorShape(shape);
  ListRows();
  factor_.resize(rows_.size());
}

// A column's rows are the matrix's and those of the columns whose first row below the diagonal it
// is (their parent in the elimination tree).
void BlockCholesky::FindFactorShape(const BlockMatrix& shape) {
  const size_t size = shape.NumRows();
  std::vector<std::vector<uint32_t>> columns(size);
  for (size_t i = 0; i < size; ++i) {
    for (size_t k = shape.row_begin[i]; k < shape.row_begin[i + 1]; ++k) {
      const auto [first, last] = std::minmax(position_[i], position_[shape.columns[k]]);
      columns[first].push_back(last);
    }
  }
  column_begin_.push_back(0);
  for (std::vector<uint32_t>& rows : columns) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (rows.size() > 1) {
      std::vector<uint32_t>& parent = columns[rows[1]];
      parent.insert(parent.end(), rows.begin() + 1, rows.end());
    }
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    column_begin_.push_back(rows_.size());
    std::vector<uint32_t>().swap(rows);
  }
}

void BlockCholesky::ListRows() {
  row_entry_begin_.assign(NumColumns() + 1, 0);
  for (size_t j = 0; j < NumColumns(); ++j) {
    for (size_t k = column_begin_[j] + 1; k < column_begin_[j + 1]; ++k) {
      ++row_entry_begin_[rows_[k] + 1];
    }
  }
  std::partial_sum(row_entry_begin_.begin(), row_entry_begin_.end(), row_entry_begin_.begin());
  row_entries_.resize(row_entry_begin_.back());
  std::vector<size_t> next = row_entry_begin_;
  for (size_t j = 0; j < NumColumns(); ++j) {
    for (size_t k = column_begin_[j] + 1; k < column_begin_[j + 1]; ++k) {
      row_entries_[next[rows_[k]]++] = {static_cast<uint32_t>(j), k};
    }
  }
}

void BlockCholesky::ScatterMatrix(const BlockMatrix& matrix, const Eigen::VectorXd& added) {
  std::fill(factor_.begin(), factor_.end(), Block::Zero());
  for (size_t i = 0; i < matrix.NumRows(); ++i) {
    for (size_t k = matrix.row_begin[i]; k < matrix.row_begin[i + 1]; ++k) {
      const uint32_t row = position_[i], column = position_[matrix.columns[k]];
      const auto [first, last] = std::minmax(row, column);
      const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(column_begin_[first]);
      const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(column_begin_[first + 1]);
      Block& block =
          factor_[static_cast<size_t>(std::lower_bound(begin, end, last) - rows_.begin())];
      if (row >= column) {
        block = matrix.blocks[k];
      } else {
        block = matrix.blocks[k].transpose();
      }
    }
    const auto first = static_cast<Eigen::Index>(kBlockSize * i);
    factor_[column_begin_[position_[i]]].diagonal() += added.segment<kBlockSize>(first);
  }
}

bool BlockCholesky::Factor(const BlockMatrix& matrix, const Eigen::VectorXd& added,
                           int num_threads) {
  ScatterMatrix(matrix, added);
  FinishedColumns finished(NumColumns());
  std::atomic<uint32_t> next{0};
  std::atomic<bool> is_definite{true};
  const auto take_columns = [&](int64_t) {
    std::vector<size_t> place_of_row(NumColumns());
    for (uint32_t j = next++; j < NumColumns(); j = next++) {
      for (size_t k = column_begin_[j]; k < column_begin_[j + 1]; ++k) place_of_row[rows_[k]] = k;
      for (size_t k = row_entry_begin_[j]; k < row_entry_begin_[j + 1]; ++k) {
        finished.WaitFor(row_entries_[k].column);
        if (is_definite) SubtractColumn(row_entries_[k], place_of_row);
      }
      if (is_definite && !FinishColumn(j)) is_definite = false;
      finished.Finish(j);
    }
  };
  ParallelFor(num_threads, EffectiveNumThreads(num_threads), take_columns);
  return is_definite;
}

void BlockCholesky::SubtractColumn(const RowEntry& entry, const std::vector<size_t>& place_of_row) {
  const Block right = factor_[entry.place].transpose();
  for (size_t k = entry.place; k < column_begin_[entry.column + 1]; ++k) {
    factor_[place_of_row[rows_[k]]].noalias() -= factor_[k].lazyProduct(right);
  }
}

bool BlockCholesky::FinishColumn(uint32_t j) {
  const size_t begin = column_begin_[j];
  const Eigen::LLT<Block> diagonal(factor_[begin]);
  if (diagonal.info() != Eigen::Success) return false;
  factor_[begin] = diagonal.matrixL();
  for (size_t k = begin + 1; k < column_begin_[j + 1]; ++k) {
    diagonal.matrixU().solveInPlace<Eigen::OnTheRight>(factor_[k]);
  }
  return true;
}

void BlockCholesky::SolveLower(size_t first, Eigen::VectorXd* x) const {
  for (size_t j = first; j < NumColumns(); ++j) {
    auto part = x->segment<kBlockSize>(static_cast<Eigen::Index>(kBlockSize * j));
    if (part.isZero(0)) continue;
    factor_[column_begin_[j]].triangularView<Eigen::Lower>().solveInPlace(part);
    for (size_t k = column_begin_[j] + 1; k < column_begin_[j + 1]; ++k) {
      x->segment<kBlockSize>(static_cast<Eigen::Index>(kBlockSize * rows_[k])) -= factor_[k] * part;
    }
  }
}

Eigen::VectorXd BlockCholesky::Solve(const Eigen::VectorXd& rhs) const {
  const auto segment = [](Eigen::VectorXd& x, size_t j) {
    return x.segment<kBlockSize>(static_cast<Eigen::Index>(kBlockSize * j));
  };
  Eigen::VectorXd x(rhs.size()), solution = rhs;
  for (size_t i = 0; i < NumColumns(); ++i) segment(x, position_[i]) = segment(solution, i);
  SolveLower(0, &x);
  for (size_t j = NumColumns(); j-- > 0;) {
    auto part = segment(x, j);
    for (size_t k = column_begin_[j] + 1; k < column_begin_[j + 1]; ++k) {
      part -= factor_[k].transpose() * segment(x, rows_[k]);
    }
    factor_[column_begin_[j]].transpose().triangularView<Eigen::Upper>().solveInPlace(part);
  }
  for (size_t i = 0; i < NumColumns(); ++i) segment(solution, i) = segment(x, position_[i]);
  return solution;
}

double BlockCholesky::InverseDiagonal(Eigen::Index index) const {
  const size_t column = position_[static_cast<size_t>(index / kBlockSize)];
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kBlockSize * NumColumns()));
  x[static_cast<Eigen::Index>(kBlockSize * column) + index % kBlockSize] = 1;
  SolveLower(column, &x);
  return x.squaredNorm();
}

}  // namespace colmap_seapoint
