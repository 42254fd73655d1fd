// See triangle_surface.h.
#include "collision/triangle_surface.h"

#include <algorithm>
#include <cmath>

namespace tumble {

Bend classify_bend(const Vec3& normal, const Vec3& tail, const Vec3& head, const Vec3& beyond,
                   const Vec3& beyond_normal) {
  const Vec3 along = head - tail, across = beyond - tail;
  const double from_edge = along.cross(across).norm() / along.norm();
  const double rise = normal.dot(across);
  if (std::abs(rise) > kFlatBend * from_edge) return rise > 0.0 ? Bend::concave : Bend::convex;
  // A sheet folded back on itself is a ridge as sharp as can be.
  return normal.dot(beyond_normal) < 0.0 ? Bend::convex : Bend::flat;
}

void TriangleSurface::query(const Aabb& bounds, std::vector<std::uint32_t>& triangles) const {
  const auto found = static_cast<std::ptrdiff_t>(triangles.size());
  visit(bounds, [&](std::uint32_t triangle) { triangles.push_back(triangle); });
  std::sort(triangles.begin() + found, triangles.end());
}

}  // namespace tumble
