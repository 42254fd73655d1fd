// See collide_triangle_hull.h. In A's frame.
#include "collision/collide_triangle_hull.h"

#include <array>
#include <cmath>

#include "collision/collide_curved.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"
#include "collision/narrow_phase.h"
#include "collision/segment.h"
#include "collision/triangle_polytope.h"
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

/// A way out of the surface: along the triangle's own normal, a neighbour's, or one between them, across their ridge.
struct WayOut {
  enum class Kind { own, neighbour, ridge };
  Kind kind = Kind::own;
  Vec3 c = Vec3::UnitZ();  ///< Unit, out of the surface.
  double separation = -kInfinity;
  std::size_t edge = 0;
  Vec3 p_body = Vec3::Zero();  ///< The body's lowest point along c.
};

WayOut go_along(const Shape& a, const PlacedTriangle& t, WayOut::Kind kind, std::size_t edge, const Vec3& c) {
  const Vec3 p = support(a, -c);
  return {kind, c, c.dot(p - t.corner[edge]), edge, p};
}

/// The best direction between the triangle's normal and the other side of a ridge: the best of samples, and between its
/// neighbours by the golden section.
WayOut cross_ridge(const Shape& a, const PlacedTriangle& t, std::size_t k) {
  constexpr int kSamples = 16, kSections = 60;
  constexpr double kGolden = 0.6180339887498949;
  const Vec3 end =
      t.bend[k] == Bend::open ? Vec3(t.along(k).cross(t.normal).normalized()) : t.beyond_normal[k];
  const auto at = [&](double share) {
    return go_along(a, t, WayOut::Kind::ridge, k,
                    direction_or((1.0 - share) * t.normal + share * end, t.normal));
  };
  int best = 0;
  double most = -kInfinity;
  for (int i = 0; i <= kSamples; ++i) {
    const double separation = at(static_cast<double>(i) / kSamples).separation;
    if (separation > most) best = i, most = separation;
  }
  double low = static_cast<double>(std::max(0, best - 1)) / kSamples,
         high = static_cast<double>(std::min(kSamples, best + 1)) / kSamples;
  for (int i = 0; i < kSections; ++i) {
    const double inner = kGolden * (high - low);
    if (at(high - inner).separation > at(low + inner).separation) {
      high = low + inner;
    } else {
      low = high - inner;
    }
  }
  return at(0.5 * (low + high));
}

/// Where the body's lowest point lies beside an edge, between its ends.
bool is_beside(const PlacedTriangle& t, std::size_t k, const Vec3& p) {
  const double along = t.along(k).dot(p - t.corner[k]);
  return along >= 0.0 && along <= t.along(k).squaredNorm();
}

/// A body near a corner may be nearer to the outside some way that the triangle has only a corner of. The corner's cone of
/// directions is spanned by planes through two of its edges; ways between these are tried in steps, which is enough to
/// know that another triangle's is shorter.
WayOut turn_round_corner(const Shape& a, const PlacedTriangle& t, std::size_t k) {
  constexpr std::size_t kEdges = 32, kRays = 8;
  constexpr int kSteps = 8;
  std::array<Vec3, kEdges> others;
  const std::size_t count = t.surface.ring(t.vertex[k], others);
  for (std::size_t i = 0; i < count; ++i) others[i] = t.R_AB * others[i] + t.p_AB - t.corner[k];
  std::array<Vec3, kRays> rays;
  std::size_t spanned = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 across = others[i].cross(others[j]);
      const double length = across.norm();
      for (const double sign : {1.0, -1.0}) {
        const Vec3 c = across * (sign / length);
        if (length > 0.0 && spanned < kRays && (t.corner_allows(k, c) || t.corner_yields(k, c)))
          rays[spanned++] = c;
      }
    }
  }
  WayOut best;
  for (std::size_t i = 0; i < spanned; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      for (int step = 0; step < (i == j ? 1 : kSteps); ++step) {
        const double share = static_cast<double>(step) / kSteps;
        const Vec3 c = direction_or(share * rays[i] + (1.0 - share) * rays[j], rays[i]);
        const WayOut way = go_along(a, t, WayOut::Kind::neighbour, k, c);
        if (way.separation > best.separation) best = way;
      }
    }
  }
  return best;
}

/// The shortest way out of those that the surface allows.
WayOut find_way_out(const Shape& a, const PlacedTriangle& t) {
  constexpr double kTie = 1e-12;
  const double tie = kTie * bounding_radius(a);
  WayOut best = go_along(a, t, WayOut::Kind::own, 0, t.normal);
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.bend[k] != Bend::convex) continue;
    const WayOut beyond = go_along(a, t, WayOut::Kind::neighbour, k, t.beyond_normal[k]);
    if (beyond.separation > best.separation + tie) best = beyond;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const WayOut round = turn_round_corner(a, t, k);
    if (round.separation > best.separation + tie) best = round;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.bend[k] != Bend::convex && t.bend[k] != Bend::open) continue;
    const WayOut across = cross_ridge(a, t, k);
    if (across.separation > best.separation + tie && is_beside(t, k, across.p_body)) best = across;
  }
  return best;
}

}  // namespace

Manifold collide_triangle_hull(const Shape& a, PlacedTriangle& t, double margin) {
  const double plane = t.normal.dot(t.corner[0]);
  const double lowest = t.normal.dot(support(a, -t.normal)) - plane;
  const double highest = t.normal.dot(support(a, t.normal)) - plane;
  if (lowest > margin || lowest + highest < 0.0) return {};
  const TrianglePolytope flat(t.corner, t.normal);
  const Mat3 identity = Mat3::Identity();
  const Vec3 zero = Vec3::Zero();
  const Manifold met = collide_pieces({a, identity, zero}, {flat, identity, zero}, -t.normal, margin);
  if (met.count == 0) return {};
  t.place_neighbours();
  const Vec3 c = -met.normal_A;
  if (same_direction(c, t.normal)) return lie_on_triangle(a, t, met, margin);
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.bend[k] == Bend::convex && same_direction(c, t.beyond_normal[k])) return {};
  }
  if (allows(t, c)) return met;
  if (t.corner_yields(t.top(c), c)) return {};
  // The shortest way out of the flat triangle is none out of the surface.
  const WayOut way = find_way_out(a, t);
  if (way.separation > margin || way.kind == WayOut::Kind::neighbour) return {};
  if (way.kind == WayOut::Kind::own) return lie_on_triangle(a, t, met, margin);
  const std::uint32_t name =
      name_crossing(0, 0, t.vertex[way.edge], t.vertex[PlacedTriangle::next(way.edge)]);
  return single_point(-way.c, way.p_body - 0.5 * way.separation * way.c, way.separation, margin, name);
}

}  // namespace tumble
