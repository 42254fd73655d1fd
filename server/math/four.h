// Four doubles side by side, for the few loops that the compiler does not turn into vector code by itself. Every lane is
// rounded as a double is, so the results are those of four scalars, to the bit, on any processor.
#pragma once

#include <array>
#include <cmath>

namespace tumble {

using Four = double __attribute__((vector_size(32)));

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
inline Four absolute(const Four& x) {
  constexpr FourFlags kAllButSign = {0x7fffffffffffffff, 0x7fffffffffffffff, 0x7fffffffffffffff,
                                     0x7fffffffffffffff};
  return (Four)((FourFlags)x & kAllButSign);
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

/// Lane i of the result is lane `from_i` of `v`.
template <int from_0, int from_1, int from_2, int from_3>
Four shuffled(const Four& v) {
  return __builtin_shufflevector(v, v, from_0, from_1, from_2, from_3);
}

}  // namespace tumble
