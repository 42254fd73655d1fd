// The sparse block factorization against the dense matrix it stands for, and the order of elimination.
#include <gtest/gtest.h>

#include <random>

#include <Eigen/Cholesky>

#include "dynamics/block_cholesky.h"

namespace tumble {
namespace {

using Edges = std::vector<BlockPattern::Edge>;

Edges chain(std::uint32_t size) {
  Edges edges;
  for (std::uint32_t i = 1; i < size; ++i) edges.emplace_back(i - 1, i);
  return edges;
}

TEST(BlockPattern, AChainFillsNothing) {
  const BlockPattern pattern(50, chain(50));
  EXPECT_EQ(pattern.block_count(), 49u);
  EXPECT_EQ(pattern.order(0), 0u) << "both ends have degree 1: the smaller index first";
}

TEST(BlockPattern, AStarIsEliminatedFromItsTipsAndFillsNothing) {
  Edges edges;
  for (std::uint32_t i = 1; i < 20; ++i) edges.emplace_back(0, i);
  const BlockPattern pattern(20, edges);
  EXPECT_EQ(pattern.block_count(), 19u);
  EXPECT_GE(pattern.position(0), 18u);
}

TEST(BlockPattern, ARingFillsOneBlockABody) {
  Edges edges = chain(10);
  edges.emplace_back(9, 0);
  edges.emplace_back(0, 9);  // repetitions do not matter
  EXPECT_EQ(BlockPattern(10, edges).block_count(), 10u + 7u);
}

/// J^T J + 1 of random block rows over the edges: symmetric positive definite with exactly the pattern.
struct RandomSystem {
  Eigen::MatrixXd dense;
  BlockCholesky sparse;

  RandomSystem(std::uint32_t size, const Edges& edges)
      : dense(Eigen::MatrixXd::Identity(6 * size, 6 * size)), sparse(BlockPattern(size, edges)) {
    std::mt19937 generator(7);
    const auto block = [&] {
      Mat6 m;
      for (int i = 0; i < 36; ++i) m(i) = static_cast<double>(generator()) / 2147483648.0 - 1.0;
      return m;
    };
    sparse.set_zero();
    for (std::uint32_t i = 0; i < size; ++i) sparse.diagonal(i).setIdentity();
    for (const auto& [a, b] : edges) {
      const std::uint32_t low = std::min(sparse.pattern().position(a), sparse.pattern().position(b));
      const std::uint32_t high = std::max(sparse.pattern().position(a), sparse.pattern().position(b));
      const Mat6 J_low = block(), J_high = block();
      const Mat6 cross = J_high.transpose() * J_low;
      sparse.diagonal(low) += J_low.transpose() * J_low;
      sparse.diagonal(high) += J_high.transpose() * J_high;
      sparse.below(sparse.pattern().block(low, high)) += cross;
      dense.block<6, 6>(6 * low, 6 * low) += J_low.transpose() * J_low;
      dense.block<6, 6>(6 * high, 6 * high) += J_high.transpose() * J_high;
      dense.block<6, 6>(6 * high, 6 * low) += cross;
      dense.block<6, 6>(6 * low, 6 * high) += cross.transpose();
    }
  }
};

TEST(BlockCholesky, SolvesLikeTheDenseMatrix) {
  const Edges edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 4}, {4, 5},
                       {5, 6}, {6, 2}, {7, 0}, {7, 6}, {8, 3}};
  RandomSystem system(10, edges);  // body 9 touches nothing
  ASSERT_TRUE(system.sparse.factorize());
  std::vector<Vec6> x(10);
  Eigen::VectorXd b(60);
  for (int i = 0; i < 60; ++i) b[i] = x[static_cast<std::size_t>(i / 6)][i % 6] = 0.1 * i - 2.0;
  system.sparse.solve(x);
  const Eigen::VectorXd expected = system.dense.llt().solve(b);
  for (int i = 0; i < 60; ++i) EXPECT_NEAR(x[static_cast<std::size_t>(i / 6)][i % 6], expected[i], 1e-12);
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefinite) {
  RandomSystem system(3, chain(3));
  system.sparse.diagonal(1)(4, 4) = -1.0;
  EXPECT_FALSE(system.sparse.factorize());
  RandomSystem poisoned(3, chain(3));
  poisoned.sparse.diagonal(2)(0, 0) = std::nan("");
  EXPECT_FALSE(poisoned.sparse.factorize());
}

}  // namespace
}  // namespace tumble
