// Where a sparse matrix of 6 x 6 blocks, one row of blocks a body, fills in when it is factorized: elimination order by
// greedy minimum degree, the block structure of the factor, and where each update goes. Depends on the body graph alone,
// so one pattern serves every factorization while the same bodies touch. (George, Liu 1989, "The evolution of the
// minimum degree ordering algorithm".)
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace tumble {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec6 = Eigen::Matrix<double, 6, 1>;

class BlockPattern {
 public:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  static constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

  /// Of a structurally symmetric matrix with `size` block rows and non-zero blocks on the diagonal and at the edges (in
  /// any order, repetitions allowed, no loops). Ties of degree go to the smallest index, so equal input, equal order.
  /// Given up as soon as a factorization would take more than `limit` products of blocks: `complete` is false then, and
  /// nothing else may be asked.
  BlockPattern(std::uint32_t size, const std::vector<Edge>& edges, std::uint64_t limit = kNoLimit);

  bool complete() const { return complete_; }
  /// Products of two blocks in a factorization: its cost.
  std::uint64_t products() const { return products_; }

  std::uint32_t size() const { return static_cast<std::uint32_t>(order_.size()); }
  /// Block row that is eliminated k-th, and its inverse.
  std::uint32_t order(std::uint32_t k) const { return order_[k]; }
  std::uint32_t position(std::uint32_t row) const { return position_[row]; }

  /// Column k of the factor below its diagonal: positions of its rows, ascending, are rows(i) for i in
  /// [column_begin(k), column_begin(k + 1)); i numbers the off-diagonal blocks.
  std::uint32_t column_begin(std::uint32_t k) const { return begin_[k]; }
  std::uint32_t row(std::uint32_t block) const { return rows_[block]; }
  std::uint32_t block_count() const { return static_cast<std::uint32_t>(rows_.size()); }

  /// Number of the off-diagonal block between the two positions (either order); it exists.
  std::uint32_t block(std::uint32_t position_a, std::uint32_t position_b) const;
  /// Block between the rows of each pair (i, j), i > j, of the blocks of a column, columns in order, i innermost.
  const std::vector<std::uint32_t>& targets() const { return targets_; }

 private:
  bool complete_ = true;
  std::uint64_t products_ = 0;
  std::vector<std::uint32_t> order_, position_, begin_, rows_, targets_;
};

}  // namespace tumble
