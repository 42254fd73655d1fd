// Half-space against everything convex: the vertices (or the lowest points of the round parts) that come closer to the
// plane than the margin. Closed forms; exact to round-off. A is the half-space, its frame's +z the normal.
#pragma once

#include "collision/manifold.h"
#include "collision/shape.h"

namespace tumble {

Manifold collide_half_space_sphere(const HalfSpace& a, const Sphere& b, const Vec3& p_AB, double margin);
Manifold collide_half_space_capsule(const HalfSpace& a, const Capsule& b, const Pose& X_AB, double margin);
Manifold collide_half_space_box(const HalfSpace& a, const Box& b, const Pose& X_AB, double margin);
Manifold collide_half_space_hull(const HalfSpace& a, const HullPointer& b, const Pose& X_AB, double margin);

}  // namespace tumble
