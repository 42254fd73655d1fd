// The direction that separates two convex shapes most, curved ones included: the nearest points of shapes that are apart,
// the way out of an overlap that is shortest. In A's frame.
//
// The separation along n is s(n) = -h(n) - rounding, where h is the reach of the Minkowski difference A - B along n. A
// polytope inside the difference (difference_hull.h) bounds h from below everywhere and so says where a better direction
// could still hide; Newton steps on the pieces that are furthest (convex_pieces.h) find the exact optimum there. While
// s > 0 there is one optimum; in an overlap there can be many, and the search ends when the polytope rules out all but
// the best, or as soon as the best has a proof of its own (depth_proof.h), which most have.
#pragma once

#include "collision/convex_pieces.h"

namespace tumble {

struct Separation {
  Vec3 normal_A = Vec3::UnitZ();  ///< Unit, from A to B.
  double separation = 0.0;        ///< Along the normal, by true supports [m].
  Vec3 p_A, p_B;  ///< The points of the cores of A and B that are nearest, or deepest, in A's frame.
  /// They are where the shapes meet. Else the search ended before it knew more than the depth: where shapes of very
  /// different size touch, or all directions round an axis are nearly as good.
  bool exact = false;
  bool proven = false;  ///< The depth was proven from the place of contact alone.
};

/// `guess`: a direction to start from (unit). Ends early with any direction that separates by more than `enough` [m].
/// Without `use_proof` every direction is ruled out one by one: the same answer up to rounding, but later.
Separation find_separation(const ConvexPieces& a, const ConvexPieces& b, const Vec3& guess, double enough,
                           bool use_proof = true);

}  // namespace tumble
