// One triangle of a surface against one convex shape. The triangle speaks for its part of the surface only: it pushes
// along directions in which the surface really is furthest out there, so that edges inside a flat or hollow surface give
// no contact of their own and a body slides over them as over a plane.
#pragma once

#include "collision/manifold.h"
#include "collision/shape.h"

namespace tumble {

/// Convex shape A against triangle `part` of surface B at X_AB. Sphere, capsule, box and hull are searched exactly, others
/// go through collide_triangle_hull. A body whose middle (between its furthest
/// points along the triangle's normal) is behind the triangle's plane is not held by the triangle's face.
Manifold collide_triangle(const Shape& a, const TriangleSurface& b, std::uint32_t part, const Pose& X_AB,
                          double margin);

}  // namespace tumble
