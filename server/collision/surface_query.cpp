// See surface_query.h.
#include "collision/surface_query.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "math/rotation.h"

namespace tumble {
namespace {

/// A triangle with nothing but its corners, which is what supports ask for; filled anew for one after the other.
class SurfaceFacet {
 public:
  SurfaceFacet() : hull_(std::make_shared<ConvexHull>()), shape_(HullPointer(hull_)) {}

  const Shape& of(const SurfaceTriangle& triangle) {
    set_corners(*hull_, triangle.corner);
    return shape_;
  }

 private:
  std::shared_ptr<ConvexHull> hull_;
  Shape shape_;
};

std::vector<std::uint32_t> triangles_near(const TriangleSurface& surface, const Aabb& bounds_B) {
  std::vector<std::uint32_t> triangles;
  surface.query(bounds_B, triangles);
  return triangles;
}

/// Whether A only touches the triangle or reaches through, by its furthest point behind the plane.
ShapeCastHit touched_at_start(const Shape& a, const SurfaceTriangle& triangle, const Pose& X_AB,
                              const Distance& start) {
  const Vec3 normal_A = rotation_matrix(X_AB.q) * triangle.normal;
  const double height = normal_A.dot(support(a, -normal_A) - X_AB * triangle.corner[0]);
  constexpr double kTouching = 1e-13;  // of the sizes: a touch, and rounding
  const double size = bounding_radius(a) + triangle.corner[0].norm() + X_AB.p.norm();
  return {.inside = height < -kTouching * size, .normal_A = normal_A, .p_A = start.b_A, .iterations = 1};
}

}  // namespace

std::optional<ShapeCastHit> cast_on_surface(const Shape& a, const TriangleSurface& surface, const Pose& X_AB,
                                            const Vec3& way_A) {
  const Mat3 R_AB = rotation_matrix(X_AB.q);
  const Vec3 way_B = R_AB.transpose() * way_A;
  SurfaceFacet facet;
  std::optional<ShapeCastHit> first;
  for (const std::uint32_t index : triangles_near(surface, compute_aabb(a, X_AB.inverse()).swept(way_B))) {
    const SurfaceTriangle triangle = surface.triangle(index);
    if (triangle.normal.dot(way_B) >= 0.0) continue;
    const Shape& shape = facet.of(triangle);
    const Distance start = compute_distance(a, shape, X_AB);
    const auto hit = start.overlap ? std::optional(touched_at_start(a, triangle, X_AB, start))
                                   : cast_from_apart(a, shape, X_AB, way_A);
    if (hit && (!first || hit->fraction < first->fraction)) first = hit;
    if (first && first->inside) break;
  }
  return first;
}

bool overlaps_surface(const Shape& a, const TriangleSurface& surface, const Pose& X_AB) {
  SurfaceFacet facet;
  const auto near = triangles_near(surface, compute_aabb(a, X_AB.inverse()));
  return std::any_of(near.begin(), near.end(), [&](std::uint32_t index) {
    return compute_distance(a, facet.of(surface.triangle(index)), X_AB).overlap;
  });
}

Distance compute_distance(const Shape& a, const TriangleSurface& surface, const Pose& X_AB) {
  const Aabb bounds_B = compute_aabb(a, X_AB.inverse());
  SurfaceFacet facet;
  const auto nearest_within = [&](double reach) {
    Distance nearest;
    nearest.upper = kInfinity;
    for (const std::uint32_t index : triangles_near(surface, bounds_B.grown(reach))) {
      const Distance distance =
          compute_distance(a, facet.of(surface.triangle(index)), X_AB, {.beyond = nearest.upper});
      if (distance.upper < nearest.upper) nearest = distance;
    }
    return nearest;
  };
  // What is found within some reach bounds the distance; all that is nearer lies within that bound.
  double reach = bounding_radius(a);
  Distance nearest = nearest_within(reach);
  while (!std::isfinite(nearest.upper)) nearest = nearest_within(reach *= 2.0);
  return nearest.upper <= reach ? nearest : nearest_within(nearest.upper * (1.0 + 1e-12));
}

}  // namespace tumble
