// Queries against a surface of triangles: a shape moved until it touches, what it overlaps, the point nearest to it. Each
// is asked of the triangles in reach, as flat convex shapes; the first or nearest wins, of equals that of lowest index.
#pragma once

#include <optional>

#include "collision/distance.h"
#include "collision/shape_cast.h"

namespace tumble {

/// As cast_shape, with the surface at X_AB. A triangle that A leaves or moves along, or moves through from behind, is not
/// met, as by rays. A is inside if it reaches through a triangle from the start; the normal is the triangle's.
std::optional<ShapeCastHit> cast_on_surface(const Shape& a, const TriangleSurface& surface, const Pose& X_AB,
                                            const Vec3& way_A);

/// True if A and a triangle share a point, up to rounding. A surface has no inside.
bool overlaps_surface(const Shape& a, const TriangleSurface& surface, const Pose& X_AB);

/// Distance to the nearest triangle.
Distance compute_distance(const Shape& a, const TriangleSurface& surface, const Pose& X_AB);

}  // namespace tumble
