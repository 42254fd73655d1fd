// A triangle of a surface against any convex shape that is no polytope: as a flat hull it goes through the shape's own pair
// functions, and what they say is kept only where the surface may push that way.
#pragma once

#include "collision/manifold.h"
#include "collision/placed_triangle.h"
#include "collision/shape.h"

namespace tumble {

Manifold collide_triangle_hull(const Shape& a, const PlacedTriangle& triangle, double margin);

/// The triangle as a hull of two faces in the frame it is given in.
HullPointer make_flat_hull(const SurfaceTriangle& triangle);

}  // namespace tumble
