// Two boxes: the axis along which they separate most, among the fifteen of the separating axis test (Gottschalk, Lin,
// Manocha, OBBTree, 1996). In A's frame.
#pragma once

#include <array>
#include <cmath>

#include "collision/shape.h"
#include "math/four.h"

namespace tumble {

/// a, b: half extents [m]; R, t: pose of B in A; columns of R are B's axes.
struct BoxPair {
  BoxPair(const Box& box_a, const Box& box_b, const Pose& X_AB);

  Vec3 a, b, t;
  Mat3 R;
  std::array<Four, 3> rows;  ///< Of R; the last lane means nothing.
  Vec3 t_B;                  ///< t, seen from B: R^T t.
  double size;               ///< [m], at least the radii of both.
};

/// The axis after k, in the cyclic order of x, y, z.
constexpr int next_axis(int k) {
  return k == 2 ? 0 : k + 1;
}

/// Corner of a box with half extents h that is furthest along d, both in its frame.
inline Vec3 furthest_corner(const Vec3& h, const Vec3& d) {
  return {std::copysign(h.x(), d.x()), std::copysign(h.y(), d.y()), std::copysign(h.z(), d.z())};
}

struct BoxAxis {
  enum class Kind { face_a, face_b, edges };
  double separation = -kInfinity;  ///< [m]
  double scale = 1.0;              ///< What makes the direction below a unit one from A to B.
  Kind kind = Kind::face_a;
  int i = 0, j = 0;  ///< The direction is axis i of A, axis j of B, or their cross product.
};

/// Unit, from A to B.
inline Vec3 normal_A(const BoxPair& pair, const BoxAxis& axis) {
  if (axis.kind == BoxAxis::Kind::face_a) return axis.scale * Vec3::Unit(axis.i);
  if (axis.kind == BoxAxis::Kind::face_b) return axis.scale * pair.R.col(axis.j);
  return axis.scale * Vec3::Unit(axis.i).cross(pair.R.col(axis.j));
}

/// The axis that separates most or, if one is beyond the margin, some such one. Of axes that are equal but for rounding
/// the first in the order faces of A, of B, edges.
BoxAxis find_axis(const BoxPair& pair, double margin);

}  // namespace tumble
