#include "colmap_seapoint/adjustment/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <random>

#include "tests/adjustment/dense_matrix.h"

namespace colmap_seapoint {
namespace {

// Positive definite: blocks near the diagonal, some far from it, and a last row of all.
BlockMatrix RandomMatrix(uint32_t size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BlockMatrix matrix;
  matrix.row_begin.push_back(0);
  for (uint32_t i = 0; i < size; ++i) {
    for (uint32_t j = 0; j <= i; ++j) {
      if (i - j > 3 && (i * 7 + j) % 23 != 0 && i + 1 != size) continue;
      Block block = Block::NullaryExpr([&] { return uniform(random); });
      if (i == j) block = Block(block + block.transpose()) + 300 * Block::Identity();
      matrix.columns.push_back(j);
      matrix.blocks.push_back(block);
    }
    matrix.row_begin.push_back(matrix.columns.size());
  }
  return matrix;
}

TEST(BlockCholeskyTest, SolvesAsTheDenseOneDoes) {
  for (uint32_t size : {1u, 2u, 40u}) {
    const BlockMatrix matrix = RandomMatrix(size);
    const Eigen::Index n = kBlockSize * size;
    const Eigen::VectorXd added = Eigen::VectorXd::LinSpaced(n, 0, 5);
    const Eigen::VectorXd rhs = Eigen::VectorXd::LinSpaced(n, -1, 2);
    Eigen::MatrixXd dense = Dense(matrix);
    dense.diagonal() += added;
    BlockCholesky cholesky(matrix);
    ASSERT_TRUE(cholesky.Factor(matrix, added, 1));
    EXPECT_LT((cholesky.Solve(rhs) - dense.llt().solve(rhs)).norm(), 1e-13);
    const Eigen::MatrixXd inverse = dense.inverse();
    for (Eigen::Index k = 0; k < n; ++k) {
      EXPECT_NEAR(cholesky.InverseDiagonal(k), inverse(k, k), 1e-14);
    }
  }
}

TEST(BlockCholeskyTest, SameBytesForAnyNumberOfThreads) {
  const BlockMatrix matrix = RandomMatrix(120);
  const Eigen::VectorXd added = Eigen::VectorXd::Zero(kBlockSize * 120);
  const Eigen::VectorXd rhs = Eigen::VectorXd::LinSpaced(kBlockSize * 120, -1, 2);
  BlockCholesky cholesky(matrix);
  ASSERT_TRUE(cholesky.Factor(matrix, added, 1));
  const Eigen::VectorXd solution = cholesky.Solve(rhs);
  for (int num_threads : {2, 5}) {
    ASSERT_TRUE(cholesky.Factor(matrix, added, num_threads));
    EXPECT_EQ(cholesky.Solve(rhs), solution);
  }
}

TEST(BlockCholeskyTest, SaysWhatIsNotPositiveDefinite) {
  BlockMatrix matrix = RandomMatrix(40);
  matrix.blocks[matrix.Find(20, 20)](3, 3) = -1;
  BlockCholesky cholesky(matrix);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(kBlockSize * 40);
  EXPECT_FALSE(cholesky.Factor(matrix, none, 1));
  EXPECT_FALSE(cholesky.Factor(matrix, none, 5));
  // It can be used again.
  EXPECT_TRUE(cholesky.Factor(matrix, Eigen::VectorXd::Constant(kBlockSize * 40, 400), 2));
}

}  // namespace
}  // namespace colmap_seapoint
