// Four doubles side by side, for sums whose components don't mix: + - * act on each lane as they would alone, so the bits
// are those of four separate numbers, on every machine and with any compiler that has vector types (gcc, clang).
#pragma once

namespace tumble {

using Lanes = double __attribute__((vector_size(4 * sizeof(double))));

/// Lane i of the result is lane `from_i` of `v`.
template <int from_0, int from_1, int from_2, int from_3>
Lanes shuffled(Lanes v) {
  return __builtin_shufflevector(v, v, from_0, from_1, from_2, from_3);
}

}  // namespace tumble
