// Sphere against the convex shapes: distance of its centre from the other shape, less the radius. Always at most one
// point; exact to round-off. A is the sphere.
#pragma once

#include "collision/manifold.h"
#include "collision/shape.h"

namespace tumble {

Manifold collide_sphere_sphere(const Sphere& a, const Sphere& b, const Vec3& p_AB, double margin);
Manifold collide_sphere_capsule(const Sphere& a, const Capsule& b, const Pose& X_AB, double margin);
Manifold collide_sphere_box(const Sphere& a, const Box& b, const Pose& X_AB, double margin);
Manifold collide_sphere_hull(const Sphere& a, const HullPointer& b, const Pose& X_AB, double margin);
Manifold collide_sphere_cylinder(const Sphere& a, const Cylinder& b, const Pose& X_AB, double margin);
Manifold collide_sphere_cone(const Sphere& a, const Cone& b, const Pose& X_AB, double margin);
Manifold collide_sphere_ellipsoid(const Sphere& a, const Ellipsoid& b, const Pose& X_AB, double margin);

}  // namespace tumble
