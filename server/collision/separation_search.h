// The direction that separates two convex shapes most, curved ones included: the nearest points of shapes that are apart,
// the way out of an overlap that is shortest. In A's frame.
//
// The separation along n is s(n) = -h(n) - rounding, where h is the reach of the Minkowski difference A - B along n. A
// polytope inside the difference (difference_hull.h) bounds h from below everywhere and so says where a better direction
// could still hide; Newton steps on the pieces that are furthest (convex_pieces.h) find the exact optimum there. While
// s > 0 there is one optimum; in an overlap there can be many, and the search ends when the polytope rules out all but
// the best.
#pragma once

#include <array>

#include "collision/convex_pieces.h"
#include "collision/difference_hull.h"

namespace tumble {

struct Separation {
  Vec3 normal_A = Vec3::UnitZ();  ///< Unit, from A to B.
  double separation = 0.0;        ///< Along the normal, by true supports [m].
  Vec3 p_A, p_B;  ///< The points of the cores of A and B that are nearest, or deepest, in A's frame.
  /// They are where the shapes meet. Else the search ended before it knew more than the depth: where shapes of very
  /// different size touch, or all directions round an axis are nearly as good.
  bool exact = false;
  /// Pieces that are furthest along the normal: one where the difference is smooth, two on its ridges, three on faces.
  int count = 0;
  std::array<PiecePair, 3> pieces;
  /// Every direction but those of this optimum separates less by at least this much [m]; <= 0: unknown.
  double lead = 0.0;
  int evaluations = 0;  ///< Furthest points asked of the pair, for tests and benchmarks.
};

/// `guess`: a direction to start from (unit). Ends early with any direction that separates by more than `enough` [m].
Separation find_separation(const ConvexPieces& a, const ConvexPieces& b, const Vec3& guess, double enough);

}  // namespace tumble
