// A triangle of a surface against any convex shape that is no polytope: as a flat body it goes through the search for
// curved shapes, and what that says is kept only where the surface may push that way.
#pragma once

#include "collision/manifold.h"
#include "collision/placed_triangle.h"
#include "collision/shape.h"

namespace tumble {

Manifold collide_triangle_hull(const Shape& a, PlacedTriangle& triangle, double margin);

}  // namespace tumble
