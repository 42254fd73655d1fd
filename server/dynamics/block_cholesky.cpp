// See block_cholesky.h. Block arithmetic is spelled out as loops of constant length with a fixed order of sums.
#include "dynamics/block_cholesky.h"

#include <cmath>
#include <utility>

namespace tumble {
namespace {

/// D <- L with D = L L^T, lower triangle; the upper one is left alone.
bool factorize_block(Mat6& D) {
  for (int j = 0; j < 6; ++j) {
    double pivot = D(j, j);
    for (int k = 0; k < j; ++k) pivot -= D(j, k) * D(j, k);
    if (!(pivot > 0.0)) return false;
    D(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < 6; ++i) {
      double sum = D(i, j);
      for (int k = 0; k < j; ++k) sum -= D(i, k) * D(j, k);
      D(i, j) = sum / D(j, j);
    }
  }
  return true;
}

/// A <- A L^-T.
void divide_by_transpose(const Mat6& L, Mat6& A) {
  for (int j = 0; j < 6; ++j) {
    for (int k = 0; k < j; ++k) {
      for (int i = 0; i < 6; ++i) A(i, j) -= A(i, k) * L(j, k);
    }
    const double inverse = 1.0 / L(j, j);
    for (int i = 0; i < 6; ++i) A(i, j) *= inverse;
  }
}

/// C <- C - A B^T.
void subtract_product(const Mat6& A, const Mat6& B, Mat6& C) {
  for (int j = 0; j < 6; ++j) {
    for (int k = 0; k < 6; ++k) {
      for (int i = 0; i < 6; ++i) C(i, j) -= A(i, k) * B(j, k);
    }
  }
}

void solve_lower(const Mat6& L, Vec6& x) {
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= L(i, k) * x[k];
    x[i] /= L(i, i);
  }
}

void solve_lower_transposed(const Mat6& L, Vec6& x) {
  for (int i = 5; i >= 0; --i) {
    for (int k = i + 1; k < 6; ++k) x[i] -= L(k, i) * x[k];
    x[i] /= L(i, i);
  }
}

}  // namespace

BlockCholesky::BlockCholesky(BlockPattern pattern)
    : pattern_(std::move(pattern)), diagonal_(pattern_.size()), below_(pattern_.block_count()) {
  for (std::uint32_t k = 0; k < pattern_.size(); ++k) {
    const std::uint32_t end = pattern_.column_begin(k + 1);
    for (std::uint32_t j = pattern_.column_begin(k); j < end; ++j) {
      for (std::uint32_t i = j + 1; i < end; ++i)
        targets_.push_back(pattern_.block(pattern_.row(i), pattern_.row(j)));
    }
  }
}

void BlockCholesky::set_zero() {
  for (Mat6& block : diagonal_) block.setZero();
  for (Mat6& block : below_) block.setZero();
}

bool BlockCholesky::factorize() {
  auto target = targets_.begin();
  for (std::uint32_t k = 0; k < pattern_.size(); ++k) {
    if (!factorize_block(diagonal_[k])) return false;
    const std::uint32_t begin = pattern_.column_begin(k), end = pattern_.column_begin(k + 1);
    for (std::uint32_t i = begin; i < end; ++i) divide_by_transpose(diagonal_[k], below_[i]);
    for (std::uint32_t j = begin; j < end; ++j) {
      subtract_product(below_[j], below_[j], diagonal_[pattern_.row(j)]);
      for (std::uint32_t i = j + 1; i < end; ++i) subtract_product(below_[i], below_[j], below_[*target++]);
    }
  }
  return true;
}

void BlockCholesky::solve(std::vector<Vec6>& x) const {
  for (std::uint32_t k = 0; k < pattern_.size(); ++k) {
    solve_lower(diagonal_[k], x[k]);
    for (std::uint32_t i = pattern_.column_begin(k); i < pattern_.column_begin(k + 1); ++i) {
      x[pattern_.row(i)] -= below_[i] * x[k];
    }
  }
  for (std::uint32_t k = pattern_.size(); k-- > 0;) {
    for (std::uint32_t i = pattern_.column_begin(k); i < pattern_.column_begin(k + 1); ++i) {
      x[k] -= below_[i].transpose() * x[pattern_.row(i)];
    }
    solve_lower_transposed(diagonal_[k], x[k]);
  }
}

}  // namespace tumble
