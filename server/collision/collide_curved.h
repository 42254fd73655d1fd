// Cylinder, cone and ellipsoid against everything: one search for the direction that separates most and one way to make
// a manifold of it, for all pairs. A shape comes as the variant, since nothing here depends on which of them it is.
#pragma once

#include "collision/convex_pieces.h"
#include "collision/manifold.h"
#include "collision/pair_cache.h"
#include "collision/shape.h"

namespace tumble {

/// Two convex shapes, neither a half-space, of which one at least is curved.
Manifold collide_curved(const Shape& a, const Shape& b, const Pose& X_AB, double margin, PairCache& cache);

/// The same of anything made of pieces, both in one frame, searched from the direction `guess` on (unit).
Manifold collide_pieces(const ConvexPieces& a, const ConvexPieces& b, const Vec3& guess, double margin);

/// A is the half-space.
Manifold collide_half_space_curved(const Shape& a, const Shape& b, const Pose& X_AB, double margin);

}  // namespace tumble
