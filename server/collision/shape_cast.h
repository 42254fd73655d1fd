// A convex shape moved along a straight line until it touches another, exactly: no step is longer than the gap that is
// proven to be free, so nothing is tunnelled through, however thin. Conservative advancement (Mirtich, "Impulse-based
// dynamic simulation", 1996) with planes instead of balls: the distance of convex shapes is a convex function of the
// way, and the steps are Newton's on it, from the safe side.
#pragma once

#include <array>
#include <optional>

#include "collision/shape.h"

namespace tumble {

struct ShapeCastHit {
  double fraction = 0.0;         ///< Of the way, 0..1; 0 if they overlap from the start.
  bool inside = false;           ///< They overlap from the start; the normal is the shortest way out.
  Vec3 normal_A = Vec3::Zero();  ///< Unit, out of B towards A.
  Vec3 p_A = Vec3::Zero();       ///< Where they touch, in the frame of A at the start [m].
  int iterations = 0;            ///< Distances computed.
};

/// A is moved by `way_A` [m] in its own frame, B stays at X_AB; both convex, B may be a half-space. None: they do not
/// touch, which a plane proves, or touch only at the start and the way leads nowhere further in. The gap left at a hit is
/// round-off of the sizes.
std::optional<ShapeCastHit> cast_shape(const Shape& a, const Shape& b, const Pose& X_AB, const Vec3& way_A);

/// The same for two shapes with ends that are apart at the start: only supports are asked of them.
std::optional<ShapeCastHit> cast_from_apart(const Shape& a, const Shape& b, const Pose& X_AB,
                                            const Vec3& way_A);

/// And for B a triangle, given by its corners in its own frame.
std::optional<ShapeCastHit> cast_from_apart(const Shape& a, const std::array<Vec3, 3>& corners,
                                            const Pose& X_AB, const Vec3& way_A);

}  // namespace tumble
