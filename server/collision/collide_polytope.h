// Box against hull and hull against hull: every facet of the Minkowski difference that could win is looked at, so the
// answer is the global one however deep the overlap; seeds from the last step make the rest fall away quickly.
#pragma once

#include "collision/manifold.h"
#include "collision/pair_cache.h"
#include "collision/shape.h"

namespace tumble {

/// Of a box and a hull, or two hulls; taken as shapes, since they are handed on as such. The cache gets the axis, the gap
/// when apart, and the winning facet with its lead.
Manifold collide_box_hull(const Shape& a, const Shape& b, const Pose& X_AB, double margin, PairCache& cache);
Manifold collide_hull_hull(const Shape& a, const Shape& b, const Pose& X_AB, double margin, PairCache& cache);

}  // namespace tumble
