// Four doubles side by side, for the few loops that the compiler does not turn into vector code by itself. Every lane is
// rounded as a double is, so the results are those of four scalars, to the bit, on any processor.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "math/types.h"

namespace tumble {

using Four = double __attribute__((vector_size(32)));

/// One in memory, among any doubles. A typedef: clang 14 lets an alias not be aligned less.
typedef double FourInMemory __attribute__((vector_size(32), aligned(8), may_alias));
static_assert(alignof(FourInMemory) == alignof(double));

/// What comparing two of them gives: lanes of 0 or -1.
using FourFlags = decltype(Four{} < Four{});

inline Four four(double x) {
  return Four{x, x, x, x};
}
inline Four four(const std::array<double, 4>& x) {
  return Four{x[0], x[1], x[2], x[3]};
}
/// The last lane is of no interest.
inline Four four(double x, double y, double z) {
  return Four{x, y, z, z};
}
inline Four four(const Vec3& v) {
  return four(v.x(), v.y(), v.z());
}
inline Four load_four(const double* from) {
  return *reinterpret_cast<const FourInMemory*>(from);
}
inline void store_four(const Four& x, double* to) {
  *reinterpret_cast<FourInMemory*>(to) = x;
}
inline Four absolute(const Four& x) {
  constexpr FourFlags kAllButSign = {0x7fffffffffffffff, 0x7fffffffffffffff, 0x7fffffffffffffff,
                                     0x7fffffffffffffff};
  return (Four)((FourFlags)x & kAllButSign);
}
inline bool any(const FourFlags& flags) {
  return (flags[0] | flags[1] | flags[2] | flags[3]) != 0;
}
inline Four larger(const Four& x, const Four& y) {
  return x > y ? x : y;
}
inline Four smaller(const Four& x, const Four& y) {
  return x < y ? x : y;
}
inline Four root(const Four& x) {
  Four y{};
  for (int i = 0; i < 4; ++i) y[i] = std::sqrt(x[i]);
  return y;
}
/// Lane i is lane i + `by` of x, the first again after the last.
template <int by>
Four rotated(const Four& x) {
  return __builtin_shufflevector(x, x, by, (by + 1) % 4, (by + 2) % 4, (by + 3) % 4);
}
/// The same of the first three lanes; the last one means nothing.
template <int by>
Four rotated_three(const Four& x) {
  return __builtin_shufflevector(x, x, by, (by + 1) % 3, (by + 2) % 3, 3);
}

/// For the lanes that are set, from the first to the last.
template <typename Do>
void for_each_lane(const FourFlags& flags, const Do& call) {
  if (!any(flags)) return;
  for (std::size_t lane = 0; lane < 4; ++lane) {
    if (flags[lane] != 0) call(lane);
  }
}

/// Lane i of the result is lane `from_i` of `v`.
template <int from_0, int from_1, int from_2, int from_3>
Four shuffled(const Four& v) {
  return __builtin_shufflevector(v, v, from_0, from_1, from_2, from_3);
}

/// The least of the four, in every lane.
inline Four least_lane(const Four& x) {
  const Four y = smaller(x, rotated<2>(x));
  return smaller(y, rotated<1>(y));
}

/// The first of the lowest among numbers that come in fours. No branches: which is the lowest can't be foreseen.
class FirstLowest {
 public:
  void look_at(const Four& next) {
    at_ = next < least_ ? index_ : at_;
    least_ = smaller(next, least_);
    index_ += 4.0;
  }
  double value() const { return least_lane(least_)[0]; }
  /// Counted from 0.
  std::uint32_t index() const {
    const Four of_least = least_ == least_lane(least_) ? at_ : four(kInfinity);
    return static_cast<std::uint32_t>(least_lane(of_least)[0]);
  }

 private:
  Four least_ = four(kInfinity), at_{}, index_ = {0.0, 1.0, 2.0, 3.0};
};

/// Four vectors or points, coordinate by coordinate.
struct FourVectors {
  Four x, y, z;
  void set(std::size_t lane, const Vec3& v) { x[lane] = v.x(), y[lane] = v.y(), z[lane] = v.z(); }
};
inline Four dot(const FourVectors& v, const Vec3& w) {
  return w.x() * v.x + w.y() * v.y + w.z() * v.z;
}

}  // namespace tumble
