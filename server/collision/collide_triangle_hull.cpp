// See collide_triangle_hull.h. In A's frame.
#include "collision/collide_triangle_hull.h"

#include <cmath>

#include "collision/collide_curved.h"
#include "collision/manifold_builder.h"
#include "collision/narrow_phase.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// Sine of the angle below which a direction is a normal of the surface itself: what iterative searches leave.
constexpr double kSameFace = 1e-6;

bool same_direction(const Vec3& a, const Vec3& b) {
  return (a - b).squaredNorm() <= kSameFace * kSameFace;
}

Manifold ask(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin) {
  PairCache cache;
  NarrowPhaseCounters counters;
  return collide(a, X_WA, b, X_WB, margin, {}, cache, counters);
}

bool lies_inside(const PlacedTriangle& t, const Vec3& p, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 outward = t.along(k).cross(t.normal).normalized();
    if (outward.dot(p - t.corner[k]) > tolerance) return false;
  }
  return true;
}

/// As PlacedTriangle asks, for a direction that is known up to kSameFace: across an edge it is taken as exactly so.
bool allows(const PlacedTriangle& t, const Vec3& c) {
  const std::size_t top = t.top(c);
  if (t.corner_allows(top, c)) return true;
  for (const std::size_t k : {top, PlacedTriangle::previous(top)}) {
    const Vec3 edge = t.along(k).normalized();
    const double slant = edge.dot(c);
    const bool borders = t.bend[k] == Bend::convex || t.bend[k] == Bend::open;
    if (borders && std::abs(slant) <= kSameFace && t.edge_allows(k, (c - slant * edge).normalized()))
      return true;
  }
  return false;
}

/// What lies over the triangle of the contact with its plane, and, if it is not all seams, what it meets of the body.
Manifold lie_on_triangle(const Shape& a, const PlacedTriangle& t, const Manifold& met, double margin) {
  const Pose X_AH{rotation_to_normal(t.normal), t.corner[0]};
  const Manifold plane = ask(HalfSpace{}, X_AH, a, Pose{}, margin);
  const ContactTolerance tolerance = ContactTolerance::of(t.width());
  ManifoldBuilder builder(-t.normal, margin, tolerance.merge);
  for (std::size_t i = 0; i < static_cast<std::size_t>(plane.count); ++i) {
    const ManifoldPoint& point = plane.points[i];
    const Vec3 p = X_AH * point.p_A;
    if (lies_inside(t, p, tolerance.inside)) builder.add(p, point.separation, point.feature);
  }
  const bool all_seams = t.bend[0] == Bend::flat && t.bend[1] == Bend::flat && t.bend[2] == Bend::flat;
  if (!all_seams && same_direction(met.normal_A, -t.normal)) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(met.count); ++i) {
      builder.add(met.points[i].p_A, met.points[i].separation, met.points[i].feature);
    }
  }
  return builder.finish();
}

}  // namespace

Manifold collide_triangle_hull(const Shape& a, const PlacedTriangle& t, double margin) {
  const double plane = t.normal.dot(t.corner[0]);
  const double lowest = t.normal.dot(support(a, -t.normal)) - plane;
  const double highest = t.normal.dot(support(a, t.normal)) - plane;
  if (lowest > margin || lowest + highest < 0.0) return {};
  const TriangleFeatures flat(t.corner, t.normal);
  const Mat3 identity = Mat3::Identity();
  const Vec3 zero = Vec3::Zero();
  const Manifold met = collide_pieces({a, identity, zero}, {flat.view(), identity, zero}, -t.normal, margin);
  if (met.count == 0) return {};
  const Vec3 c = -met.normal_A;
  if (same_direction(c, t.normal)) return lie_on_triangle(a, t, met, margin);
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.bend[k] == Bend::convex && same_direction(c, t.beyond_normal[k])) return {};
  }
  return allows(t, c) ? met : lie_on_triangle(a, t, met, margin);
}

}  // namespace tumble
