// Box against box: the fifteen-axis separating axis test (Gottschalk, Lin, Manocha, OBBTree, 1996), then face clipping
// or the closest points of two edges. Exact to round-off; prefers faces on near ties, so that stacks don't flip.
#pragma once

#include "collision/manifold.h"
#include "collision/pair_cache.h"
#include "collision/shape.h"

namespace tumble {

/// The cache gets the axis and the gap when the boxes are apart.
Manifold collide_box_box(const Box& a, const Box& b, const Pose& X_AB, double margin, PairCache& cache);

}  // namespace tumble
