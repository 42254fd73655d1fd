// See block_lu.h. Columns of six are handled as four and two lanes, each lane on its own and sums in a fixed order, so
// the bits do not depend on the instruction set.
#include "dynamics/block_lu.h"

#include <cmath>
#include <cstring>
#include <utility>

namespace tumble {
namespace {

struct Column {
  typedef double Four __attribute__((vector_size(32)));
  typedef double Two __attribute__((vector_size(16)));
  Four top;
  Two bottom;

  explicit Column(const double* from) {
    std::memcpy(&top, from, sizeof top);
    std::memcpy(&bottom, from + 4, sizeof bottom);
  }
  void store(double* to) const {
    std::memcpy(to, &top, sizeof top);
    std::memcpy(to + 4, &bottom, sizeof bottom);
  }
  /// this <- this - x other
  void subtract(double x, const Column& other) {
    top -= x * other.top;
    bottom -= x * other.bottom;
  }
};

/// C <- C - A B.
void subtract_product(const Mat6& A, const Mat6& B, Mat6& C) {
  const double* a = A.data();
  const Column A0(a), A1(a + 6), A2(a + 12), A3(a + 18), A4(a + 24), A5(a + 30);
  for (int j = 0; j < 6; ++j) {
    const double* b = B.data() + 6 * j;
    Column c(C.data() + 6 * j);
    c.subtract(b[0], A0);
    c.subtract(b[1], A1);
    c.subtract(b[2], A2);
    c.subtract(b[3], A3);
    c.subtract(b[4], A4);
    c.subtract(b[5], A5);
    c.store(C.data() + 6 * j);
  }
}

/// x <- x - A y.
void subtract_product(const Mat6& A, const Vec6& y, Vec6& x) {
  Column sum(x.data());
  for (int k = 0; k < 6; ++k) sum.subtract(y[k], Column(A.data() + 6 * k));
  sum.store(x.data());
}

}  // namespace

BlockLu::BlockLu(std::shared_ptr<const BlockPattern> pattern)
    : pattern_(std::move(pattern)),
      diagonal_(pattern_->size()),
      lower_(pattern_->block_count()),
      upper_(pattern_->block_count()) {}

void BlockLu::set_zero() {
  for (Pivot& pivot : diagonal_) pivot.LU.setZero();
  for (Mat6& block : lower_) block.setZero();
  for (Mat6& block : upper_) block.setZero();
}

bool BlockLu::factorize_block(Pivot& pivot) {
  Mat6& A = pivot.LU;
  for (int k = 0; k < 6; ++k) {
    int best = k;
    for (int i = k + 1; i < 6; ++i) {
      if (std::abs(A(i, k)) > std::abs(A(best, k))) best = i;
    }
    pivot.pivot[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(best);
    if (best != k) A.row(k).swap(A.row(best));
    if (!(std::abs(A(k, k)) > 0.0)) return false;
    const double inverse = 1.0 / A(k, k);
    for (int i = k + 1; i < 6; ++i) A(i, k) *= inverse;
    for (int j = k + 1; j < 6; ++j) {
      for (int i = k + 1; i < 6; ++i) A(i, j) -= A(i, k) * A(k, j);
    }
  }
  return true;
}

/// A <- A D^-1 = A U^-1 L^-1 P: only columns are combined.
void BlockLu::divide(const Pivot& pivot, Mat6& A) {
  const Mat6& LU = pivot.LU;
  double* a = A.data();
  for (int j = 0; j < 6; ++j) {
    Column column(a + 6 * j);
    for (int k = 0; k < j; ++k) column.subtract(LU(k, j), Column(a + 6 * k));
    const double inverse = 1.0 / LU(j, j);
    column.top *= inverse;
    column.bottom *= inverse;
    column.store(a + 6 * j);
  }
  for (int j = 5; j-- > 0;) {
    Column column(a + 6 * j);
    for (int k = j + 1; k < 6; ++k) column.subtract(LU(k, j), Column(a + 6 * k));
    column.store(a + 6 * j);
  }
  for (int k = 6; k-- > 0;) {
    const int other = pivot.pivot[static_cast<std::size_t>(k)];
    if (other != k) A.col(k).swap(A.col(other));
  }
}

/// x <- D^-1 x.
void BlockLu::solve_block(const Pivot& pivot, Vec6& x) {
  const Mat6& LU = pivot.LU;
  for (int k = 0; k < 6; ++k) std::swap(x[k], x[pivot.pivot[static_cast<std::size_t>(k)]]);
  for (int i = 1; i < 6; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= LU(i, k) * x[k];
  }
  for (int i = 6; i-- > 0;) {
    for (int k = i + 1; k < 6; ++k) x[i] -= LU(i, k) * x[k];
    x[i] /= LU(i, i);
  }
}

bool BlockLu::factorize() {
  auto target = pattern_->targets().begin();
  for (std::uint32_t k = 0; k < pattern_->size(); ++k) {
    if (!factorize_block(diagonal_[k])) return false;
    const std::uint32_t begin = pattern_->column_begin(k), end = pattern_->column_begin(k + 1);
    for (std::uint32_t i = begin; i < end; ++i) divide(diagonal_[k], lower_[i]);
    for (std::uint32_t j = begin; j < end; ++j) {
      subtract_product(lower_[j], upper_[j], diagonal_[pattern_->row(j)].LU);
      for (std::uint32_t i = j + 1; i < end; ++i, ++target) {
        subtract_product(lower_[i], upper_[j], lower_[*target]);
        subtract_product(lower_[j], upper_[i], upper_[*target]);
      }
    }
  }
  return true;
}

void BlockLu::solve(std::vector<Vec6>& x) const {
  for (std::uint32_t k = 0; k < pattern_->size(); ++k) {
    for (std::uint32_t i = pattern_->column_begin(k); i < pattern_->column_begin(k + 1); ++i)
      subtract_product(lower_[i], x[k], x[pattern_->row(i)]);
  }
  for (std::uint32_t k = pattern_->size(); k-- > 0;) {
    for (std::uint32_t i = pattern_->column_begin(k); i < pattern_->column_begin(k + 1); ++i)
      subtract_product(upper_[i], x[pattern_->row(i)], x[k]);
    solve_block(diagonal_[k], x[k]);
  }
}

}  // namespace tumble
