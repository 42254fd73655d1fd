// Two boxes: the axis along which they separate most, among the fifteen of the separating axis test (Gottschalk, Lin,
// Manocha, OBBTree, 1996). In A's frame.
#pragma once

#include <cmath>

#include "collision/shape.h"

namespace tumble {

/// a, b: half extents [m]; R, t: pose of B in A; columns of R are B's axes.
struct BoxPair {
  BoxPair(const Box& box_a, const Box& box_b, const Pose& X_AB);

  Vec3 a, b, t;
  Mat3 R, R_abs;
};

/// Corner of a box with half extents h that is furthest along d, both in its frame.
inline Vec3 furthest_corner(const Vec3& h, const Vec3& d) {
  return {std::copysign(h.x(), d.x()), std::copysign(h.y(), d.y()), std::copysign(h.z(), d.z())};
}

struct BoxAxis {
  enum class Kind { face_a, face_b, edges };
  double separation = -kInfinity;  // [m]
  Vec3 normal_A = Vec3::UnitZ();   // unit, from A to B
  Kind kind = Kind::face_a;
  int i = 0, j = 0;  // faces across axis i of A, or j of B; edges along both
};

/// The axis that separates most or, if one is beyond the margin, some such one. Of axes that are equal but for rounding
/// the first in the order faces of A, of B, edges.
BoxAxis find_axis(const BoxPair& pair, double margin);

}  // namespace tumble
