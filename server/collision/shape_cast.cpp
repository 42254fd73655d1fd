// See shape_cast.h.
#include "collision/shape_cast.h"

#include <algorithm>

#include "collision/distance.h"
#include "collision/narrow_phase.h"
#include "collision/surface_query.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// Far more than is ever needed: at a grazing touch, the worst, every step halves the gap.
constexpr int kCastSteps = 200;

/// B: a shape, or the corners of a triangle.
template <typename B>
double rounding_of(const Shape& a, const B& b, const Pose& X_AB) {
  return kSeparationRounding * (bounding_radius(a) + bounding_radius(b) + X_AB.p.norm());
}

/// The plane's distance is linear along the way.
std::optional<ShapeCastHit> cast_on_half_space(const Shape& a, const Pose& X_AB, const Vec3& way_A) {
  const Vec3 n = rotation_matrix(X_AB.q).col(2);
  const Vec3 lowest = support(a, -n);
  const double gap = n.dot(lowest - X_AB.p), closing = -n.dot(way_A);
  ShapeCastHit hit{.normal_A = n, .p_A = lowest, .iterations = 1};
  if (gap < 0.0) {
    hit.inside = true;
    return hit;
  }
  if (closing <= 0.0 || gap > closing) return std::nullopt;
  hit.fraction = gap / closing;
  hit.p_A += hit.fraction * way_A;
  return hit;
}

/// They overlap or touch before any motion: the exact contact decides, and whether the way leads further in.
std::optional<ShapeCastHit> judge_start(const Shape& a, const Shape& b, const Pose& X_AB, const Vec3& way_A,
                                        double touching) {
  PairCache cache;
  NarrowPhaseCounters counters;
  const Manifold manifold = collide(a, {}, b, X_AB, touching, {}, cache, counters);
  if (manifold.count == 0) return std::nullopt;
  const auto deepest = std::min_element(
      manifold.points.begin(), manifold.points.begin() + manifold.count,
      [](const ManifoldPoint& p, const ManifoldPoint& q) { return p.separation < q.separation; });
  const bool inside = deepest->separation < -touching;
  if (!inside && manifold.normal_A.dot(way_A) <= 0.0) return std::nullopt;
  return ShapeCastHit{.inside = inside, .normal_A = -manifold.normal_A, .p_A = deepest->p_A, .iterations = 1};
}

/// Of shapes that are apart. B: as above.
template <typename B>
std::optional<ShapeCastHit> advance_to_touch(const Shape& a, const B& b, const Pose& X_AB,
                                             const Vec3& way_A) {
  // Steps end a little short of the plane, where the axis is still well defined; only the last goes all the way.
  const double ahead = 4.0 * rounding_of(a, b, X_AB);
  ShapeCastHit hit;
  DistanceSettings settings;
  while (hit.iterations < kCastSteps) {
    const Pose X_now{X_AB.q, X_AB.p - hit.fraction * way_A};
    const Distance distance = compute_distance(a, b, X_now, settings);
    ++hit.iterations;
    if (distance.overlap) break;
    const double closing = distance.axis_A.dot(way_A);
    if (closing <= 0.0 || distance.lower > (1.0 - hit.fraction) * closing) return std::nullopt;
    const bool last = distance.lower <= 2.0 * ahead;
    hit.normal_A = -distance.axis_A;
    hit.p_A = distance.b_A + hit.fraction * way_A;
    hit.fraction += (last ? distance.lower : distance.lower - ahead) / closing;
    if (last) break;
    settings.start = distance.carriers;
  }
  return hit;
}

}  // namespace

std::optional<ShapeCastHit> cast_shape(const Shape& a, const Shape& b, const Pose& X_AB, const Vec3& way_A) {
  if (std::holds_alternative<HalfSpace>(b)) return cast_on_half_space(a, X_AB, way_A);
  if (const TriangleSurface* surface = surface_of(b)) return cast_on_surface(a, *surface, X_AB, way_A);
  const double round_off = rounding_of(a, b, X_AB);
  if (compute_distance(a, b, X_AB, {.beyond = round_off}).lower <= round_off) {
    return judge_start(a, b, X_AB, way_A, round_off);
  }
  return cast_from_apart(a, b, X_AB, way_A);
}

std::optional<ShapeCastHit> cast_from_apart(const Shape& a, const Shape& b, const Pose& X_AB,
                                            const Vec3& way_A) {
  return advance_to_touch(a, b, X_AB, way_A);
}

std::optional<ShapeCastHit> cast_from_apart(const Shape& a, const std::array<Vec3, 3>& corners,
                                            const Pose& X_AB, const Vec3& way_A) {
  return advance_to_touch(a, corners, X_AB, way_A);
}

}  // namespace tumble
