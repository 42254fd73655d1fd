// Sparse factorization of a matrix of 6 x 6 blocks, one block row a body: the linear algebra of the interior point and
// the Newton method, whose matrices have a symmetric pattern but, where contacts slide, no symmetric values.
// Right-looking, in the elimination order of a BlockPattern, with pivots exchanged inside the diagonal blocks only. Rows
// are addressed by their position in that order.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "dynamics/block_pattern.h"

namespace tumble {

class BlockLu {
 public:
  /// The pattern is complete.
  explicit BlockLu(std::shared_ptr<const BlockPattern> pattern);
  const BlockPattern& pattern() const { return *pattern_; }

  /// The matrix is filled anew for every factorization, which overwrites it.
  void set_zero();
  Mat6& diagonal(std::uint32_t position) { return diagonal_[position].LU; }
  /// Blocks (row, column) and (column, row) with row > column, both positions, numbered by pattern().block().
  Mat6& lower(std::uint32_t block) { return lower_[block]; }
  Mat6& upper(std::uint32_t block) { return upper_[block]; }

  /// False if a pivot is zero or not a number; the factor is of no use then.
  bool factorize();
  /// x <- A^-1 x, block rows by position.
  void solve(std::vector<Vec6>& x) const;

 private:
  /// P A = L U, L with ones on its diagonal, in one block; the k-th exchange is of rows k and pivot[k].
  struct Pivot {
    Mat6 LU;
    std::array<std::uint8_t, 6> pivot;
  };
  static bool factorize_block(Pivot& pivot);
  static void divide(const Pivot& pivot, Mat6& A);
  static void solve_block(const Pivot& pivot, Vec6& x);

  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<Pivot> diagonal_;
  std::vector<Mat6> lower_, upper_;
};

}  // namespace tumble
