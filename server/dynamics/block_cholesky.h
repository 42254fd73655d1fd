// Sparse Cholesky factorization L L^T of a symmetric positive definite matrix of 6 x 6 blocks, one block row a body:
// the linear algebra of the interior point solver. Right-looking, in the elimination order of a BlockPattern; rows are
// addressed by their position in that order.
#pragma once

#include <vector>

#include "dynamics/block_pattern.h"

namespace tumble {

class BlockCholesky {
 public:
  explicit BlockCholesky(BlockPattern pattern);
  const BlockPattern& pattern() const { return pattern_; }

  /// The matrix is filled anew for every factorization, which overwrites it.
  void set_zero();
  Mat6& diagonal(std::uint32_t position) { return diagonal_[position]; }
  /// Block (row, column) with row > column, both positions, numbered by pattern().block().
  Mat6& below(std::uint32_t block) { return below_[block]; }

  /// False if a pivot is not positive or not a number; the factor is of no use then.
  bool factorize();
  /// x <- A^-1 x, block rows by position.
  void solve(std::vector<Vec6>& x) const;

 private:
  BlockPattern pattern_;
  std::vector<Mat6> diagonal_, below_;
  std::vector<std::uint32_t>
      targets_;  // block that each update of a pair of rows of a column goes to, in loop order
};

}  // namespace tumble
