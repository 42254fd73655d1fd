// The sparse block factorization against the dense matrix it stands for, the order of elimination, and what is kept of it.
#include <gtest/gtest.h>

#include <random>

#include <Eigen/LU>

#include "dynamics/block_lu.h"
#include "dynamics/pattern_store.h"

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

TEST(BlockPattern, CountsTheProductsOfAFactorizationAndGivesUpAboveALimit) {
  // A chain: 9 bodies with one later neighbour (pivot, column, update), and the last one.
  EXPECT_EQ(BlockPattern(10, chain(10)).products(), 9u * 3u + 1u);
  EXPECT_TRUE(BlockPattern(10, chain(10), 28).complete());
  EXPECT_FALSE(BlockPattern(10, chain(10), 27).complete());
}

TEST(PatternStore, FindsAPatternAgainWhileItIsAskedForEveryStep) {
  PatternStore store;
  const auto first = store.find(10, chain(10), BlockPattern::kNoLimit);
  store.end_step();
  EXPECT_EQ(store.find(10, chain(10), BlockPattern::kNoLimit), first);
  Edges other = chain(10);
  other.pop_back();
  EXPECT_NE(store.find(10, other, BlockPattern::kNoLimit), first);
  EXPECT_EQ(store.found(), 1u);
  EXPECT_EQ(store.made(), 2u);
  store.end_step();
  store.end_step();
  store.find(10, chain(10), BlockPattern::kNoLimit);
  EXPECT_EQ(store.made(), 3u) << "forgotten after a step without it";
}

/// 1 + J^T G J of random block rows J over the edges with one unsymmetric G: exactly the pattern, and regular.
struct RandomSystem {
  Eigen::MatrixXd dense;
  BlockLu sparse;

  RandomSystem(std::uint32_t size, const Edges& edges)
      : dense(Eigen::MatrixXd::Identity(6 * size, 6 * size)),
        sparse(std::make_shared<const BlockPattern>(size, edges)) {
    std::mt19937 generator(7);
    const auto block = [&] {
      Mat6 m;
      for (int i = 0; i < 36; ++i) m(i) = static_cast<double>(generator()) / 2147483648.0 - 1.0;
      return m;
    };
    const Mat6 G = Mat6::Identity() + 0.2 * block();
    sparse.set_zero();
    for (std::uint32_t i = 0; i < size; ++i) sparse.diagonal(i).setIdentity();
    for (const auto& [a, b] : edges) {
      const std::uint32_t low = std::min(sparse.pattern().position(a), sparse.pattern().position(b));
      const std::uint32_t high = std::max(sparse.pattern().position(a), sparse.pattern().position(b));
      const std::uint32_t between = sparse.pattern().block(low, high);
      const Mat6 J_low = block(), J_high = block();
      add(sparse.diagonal(low), low, low, J_low.transpose() * G * J_low);
      add(sparse.diagonal(high), high, high, J_high.transpose() * G * J_high);
      add(sparse.lower(between), high, low, J_high.transpose() * G * J_low);
      add(sparse.upper(between), low, high, J_low.transpose() * G * J_high);
    }
  }
  void add(Mat6& block, std::uint32_t row, std::uint32_t column, const Mat6& value) {
    block += value;
    dense.block<6, 6>(6 * row, 6 * column) += value;
  }
};

TEST(BlockLu, SolvesLikeTheDenseMatrix) {
  const Edges edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 4}, {4, 5},
                       {5, 6}, {6, 2}, {7, 0}, {7, 6}, {8, 3}};
  RandomSystem system(10, edges);  // body 9 touches nothing
  ASSERT_TRUE(system.sparse.factorize());
  std::vector<Vec6> x(10);
  Eigen::VectorXd b(60);
  for (int i = 0; i < 60; ++i) b[i] = x[static_cast<std::size_t>(i / 6)][i % 6] = 0.1 * i - 2.0;
  system.sparse.solve(x);
  const Eigen::VectorXd expected = system.dense.partialPivLu().solve(b);
  for (int i = 0; i < 60; ++i) EXPECT_NEAR(x[static_cast<std::size_t>(i / 6)][i % 6], expected[i], 1e-12);
}

TEST(BlockLu, RefusesWhatIsSingular) {
  RandomSystem system(3, {});
  system.sparse.diagonal(1).row(4).setZero();
  EXPECT_FALSE(system.sparse.factorize());
  RandomSystem poisoned(3, chain(3));
  poisoned.sparse.diagonal(2)(0, 0) = std::nan("");
  EXPECT_FALSE(poisoned.sparse.factorize());
}

}  // namespace
}  // namespace tumble
