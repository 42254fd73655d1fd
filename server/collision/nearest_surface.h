// Where the surface of a curved solid is nearest to a point, inside or outside; closed forms but for the ellipsoid's root.
#pragma once

#include "collision/shape.h"

namespace tumble {

struct NearestSurface {
  double distance;  ///< From the solid's surface [m]; < 0 inside.
  Vec3 outward_S;   ///< Unit, along the line through both, out of the solid.
};
NearestSurface nearest_surface(const Cylinder& c, const Vec3& p_S);
NearestSurface nearest_surface(const Cone& c, const Vec3& p_S);
NearestSurface nearest_surface(const Ellipsoid& e, const Vec3& p_S);

}  // namespace tumble
