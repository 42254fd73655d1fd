// Capsule against capsule, box and hull: its segment against the other shape, less the radius. Up to two points when
// the segment lies along the other's face or segment. A is the capsule.
#pragma once

#include "collision/manifold.h"
#include "collision/pair_cache.h"
#include "collision/shape.h"

namespace tumble {

Manifold collide_capsule_capsule(const Capsule& a, const Capsule& b, const Pose& X_AB, double margin);

/// Exact features: the cache gets the axis and the gap when apart.
Manifold collide_capsule_box(const Capsule& a, const Box& b, const Pose& X_AB, double margin,
                             PairCache& cache);
Manifold collide_capsule_hull(const Capsule& a, const HullPointer& b, const Pose& X_AB, double margin,
                              PairCache& cache);

}  // namespace tumble
