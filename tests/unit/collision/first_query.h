// A pair's first query: nothing remembered, nothing counted.
#pragma once

#include "collision/narrow_phase.h"

namespace tumble::test {

inline Manifold query(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                      const NarrowPhaseOptions& options = {}, std::uint32_t part = 0) {
  PairCache cache;
  NarrowPhaseCounters counters;
  return collide(a, X_WA, b, X_WB, margin, options, cache, counters, part);
}

}  // namespace tumble::test
