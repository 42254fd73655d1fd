// See surface_query.h.
#include "collision/surface_query.h"

#include <cmath>
#include <utility>

#include "math/rotation.h"

namespace tumble {
namespace {

/// A fraction or a distance, and the triangle it belongs to. Triangles come in any order: the least of these wins.
using Rank = std::pair<double, std::uint32_t>;
constexpr Rank kLast = {kInfinity, 0xffffffffu};

/// Whether A only touches the triangle or reaches through, by its furthest point behind the plane.
ShapeCastHit touched_at_start(const Shape& a, const SurfaceTriangle& triangle, const Pose& X_AB,
                              const Distance& start) {
  const Vec3 normal_A = rotation_matrix(X_AB.q) * triangle.normal;
  const double height = normal_A.dot(support(a, -normal_A) - X_AB * triangle.corner[0]);
  constexpr double kTouchingSurface = 1e-13;  // of the sizes: a touch, and rounding
  const double size = bounding_radius(a) + triangle.corner[0].norm() + X_AB.p.norm();
  return {
      .inside = height < -kTouchingSurface * size, .normal_A = normal_A, .p_A = start.b_A, .iterations = 1};
}

}  // namespace

std::optional<ShapeCastHit> cast_on_surface(const Shape& a, const TriangleSurface& surface, const Pose& X_AB,
                                            const Vec3& way_A) {
  const Vec3 way_B = rotation_matrix(X_AB.q).transpose() * way_A;
  std::optional<ShapeCastHit> first;
  Rank least = kLast;
  const auto meet = [&](std::uint32_t index) {
    // Once something is met at the start, only a lower index can come before it.
    if (least < Rank{0.0, index}) return;
    const SurfaceTriangle triangle = surface.triangle(index);
    if (triangle.normal.dot(way_B) >= 0.0) return;
    const Distance start = compute_distance(a, triangle.corner, X_AB);
    const auto hit = start.overlap ? std::optional(touched_at_start(a, triangle, X_AB, start))
                                   : cast_from_apart(a, triangle.corner, X_AB, way_A);
    if (!hit || !(Rank{hit->fraction, index} < least)) return;
    first = hit;
    least = {hit->fraction, index};
  };
  surface.visit(compute_aabb(a, X_AB.inverse()).swept(way_B), meet);
  return first;
}

bool overlaps_surface(const Shape& a, const TriangleSurface& surface, const Pose& X_AB) {
  bool overlap = false;
  const auto look = [&](std::uint32_t index) {
    overlap = overlap || compute_distance(a, surface.triangle(index).corner, X_AB).overlap;
  };
  surface.visit(compute_aabb(a, X_AB.inverse()), look);
  return overlap;
}

Distance compute_distance(const Shape& a, const TriangleSurface& surface, const Pose& X_AB) {
  const Aabb bounds_B = compute_aabb(a, X_AB.inverse());
  const auto nearest_within = [&](double reach) {
    Distance nearest;
    nearest.upper = kInfinity;
    Rank least = kLast;
    const auto measure = [&](std::uint32_t index) {
      const Distance distance =
          compute_distance(a, surface.triangle(index).corner, X_AB, {.beyond = nearest.upper});
      if (!(Rank{distance.upper, index} < least)) return;
      nearest = distance;
      least = {distance.upper, index};
    };
    surface.visit(bounds_B.grown(reach), measure);
    return nearest;
  };
  // What is found within some reach bounds the distance; all that is nearer lies within that bound.
  double reach = bounding_radius(a);
  Distance nearest = nearest_within(reach);
  while (!std::isfinite(nearest.upper)) nearest = nearest_within(reach *= 2.0);
  return nearest.upper <= reach ? nearest : nearest_within(nearest.upper * (1.0 + 1e-12));
}

}  // namespace tumble
