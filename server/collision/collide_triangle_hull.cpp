// See collide_triangle_hull.h. In A's frame.
#include "collision/collide_triangle_hull.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "collision/collide_curved.h"
#include "collision/distance.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"
#include "collision/narrow_phase.h"
#include "collision/nearest_surface.h"
#include "collision/segment.h"
#include "collision/triangle_polytope.h"
#include "math/rotation.h"

namespace tumble {
namespace {

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

/// Whether the middle of the body is further in than the triangle, along c.
bool is_behind(const Shape& a, const PlacedTriangle& t, const Vec3& c) {
  return c.dot(support(a, -c) + support(a, c)) < 2.0 * c.dot(t.corner[t.top(c)]);
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
  if (!all_seams && PlacedTriangle::same_direction(met.normal_A, -t.normal)) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(met.count); ++i) {
      builder.add(met.points[i].p_A, met.points[i].separation, met.points[i].feature);
    }
  }
  return builder.finish();
}

/// A way out of the surface: along the triangle's own normal, across one of its ridges, off one of its corners, or some way
/// that other triangles have.
struct WayOut {
  enum class Kind { own, neighbour, ridge, corner };
  Kind kind = Kind::own;
  Vec3 c = Vec3::UnitZ();  ///< Unit, out of the surface.
  double separation = -kInfinity;
  std::size_t place = 0;       ///< The corner or ridge.
  Vec3 p_body = Vec3::Zero();  ///< The body's lowest point along c.
};

/// Corner `place`, or the ridge from there on, is furthest out along c.
WayOut go_along(const Shape& a, const PlacedTriangle& t, WayOut::Kind kind, std::size_t place,
                const Vec3& c) {
  const Vec3 p = support(a, -c);
  return {kind, c, c.dot(p - t.corner[place]), place, p};
}

/// The best between two directions: the best of samples, and between its neighbours by the golden section.
WayOut go_between(const Shape& a, const PlacedTriangle& t, WayOut::Kind kind, std::size_t place,
                  const Vec3& from, const Vec3& to) {
  constexpr int kSamples = 16, kSections = 60;
  constexpr double kGolden = 0.6180339887498949;
  const auto at = [&](double share) {
    return go_along(a, t, kind, place, direction_or((1.0 - share) * from + share * to, from));
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

/// Where p lies beside an edge, between its ends but for rounding.
bool is_beside(const PlacedTriangle& t, std::size_t k, const Vec3& p) {
  constexpr double kEnd = 1e-9;
  const double length2 = t.along(k).squaredNorm(), along = t.along(k).dot(p - t.corner[k]) / length2;
  return along >= -kEnd && along <= 1.0 + kEnd;
}

/// A ridge that goes on straight is left to the triangle that has the piece where the body is lowest.
WayOut cross_ridge(const Shape& a, const PlacedTriangle& t, std::size_t k) {
  WayOut way = go_between(a, t, WayOut::Kind::ridge, k, t.normal, t.normal_across(k));
  if (!is_beside(t, k, way.p_body)) way.kind = WayOut::Kind::neighbour;
  return way;
}

/// The directions along which a corner of the surface is furthest out are a cone. Its rays are normals of the faces there:
/// each is square to two or more of the edges that leave the corner, which are bits of `spokes`.
struct ConeOfCorner {
  struct Ray {
    Vec3 c;
    std::uint32_t spokes;
  };
  static constexpr std::size_t kRays = 16;

  ConeOfCorner(const PlacedTriangle& t, std::size_t k) {
    std::array<Vec3, PlacedTriangle::kSpokes> spokes;
    const std::size_t of_surface = t.find_spokes(k, spokes);
    for (std::size_t i = 0; i < of_surface; ++i) {
      if (is_same(spokes[i], t.along(k)) || is_same(spokes[i], -t.along(PlacedTriangle::previous(k))))
        own |= 1u << i;
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 across = direction_or(spokes[i].cross(spokes[j]), Vec3::Zero());
        for (const double sign : {1.0, -1.0}) add(t, k, sign * across, 1u << i | 1u << j);
      }
    }
  }

  std::array<Ray, kRays> rays;
  std::size_t count = 0;
  std::uint32_t own = 0;  ///< Spokes that are edges of the triangle.

 private:
  static bool is_same(const Vec3& spoke, const Vec3& edge) {
    return (spoke - edge).squaredNorm() <= 1e-18 * edge.squaredNorm();
  }
  void add(const PlacedTriangle& t, std::size_t k, const Vec3& c, std::uint32_t spokes) {
    if (c.isZero(0.0) || !(t.corner_allows(k, c) || t.corner_yields(k, c))) return;
    const auto end = rays.begin() + static_cast<std::ptrdiff_t>(count);
    const auto known = std::find_if(rays.begin(), end,
                                    [&](const Ray& ray) { return PlacedTriangle::same_direction(ray.c, c); });
    if (known != end) {
      known->spokes |= spokes;
    } else if (count < kRays) {
      rays[count++] = {c, spokes};
    }
  }
};

/// Unit normals of each part of a body's surface at its place nearest to p, of an ellipsoid at the nearest one.
struct NormalsAround {
  NormalsAround(const Shape& a, const Vec3& p) {
    const Vec3 beside = direction_or(Vec3(p.x(), p.y(), 0.0), Vec3::UnitX());
    if (std::holds_alternative<Cylinder>(a)) {
      normals = {Vec3::UnitZ(), -Vec3::UnitZ(), beside};
      count = 3;
    } else if (const auto* cone = std::get_if<Cone>(&a)) {
      normals[0] = -Vec3::UnitZ();
      normals[1] = (2.0 * cone->half_length * beside + cone->radius * Vec3::UnitZ()).normalized();
      count = 2;
    } else {
      normals[0] = nearest_surface(*std::get_if<Ellipsoid>(&a), p).outward_S;
      count = 1;
    }
  }
  std::array<Vec3, 3> normals;
  std::size_t count;
};

/// A body near a corner may be nearer to the outside along a normal or across a ridge that the triangle has only a corner
/// of, or to the corner itself.
WayOut turn_round_corner(const Shape& a, const PlacedTriangle& t, std::size_t k) {
  WayOut best;
  const auto offer = [&](const WayOut& way) {
    if (way.separation > best.separation) best = way;
  };
  const ConeOfCorner cone(t, k);
  for (std::size_t i = 0; i < cone.count; ++i) {
    const ConeOfCorner::Ray& ray = cone.rays[i];
    offer(go_along(a, t, WayOut::Kind::neighbour, k, ray.c));
    for (std::size_t j = 0; j < i; ++j) {
      if ((ray.spokes & cone.rays[j].spokes & ~cone.own) != 0)
        offer(go_between(a, t, WayOut::Kind::neighbour, k, cone.rays[j].c, ray.c));
    }
  }
  const NormalsAround around(a, t.corner[k]);
  for (std::size_t i = 0; i < around.count; ++i) {
    const Vec3 c = -around.normals[i];
    if (t.corner_allows(k, c)) {
      offer(go_along(a, t, WayOut::Kind::corner, k, c));
    } else if (t.corner_yields(k, c)) {
      offer(go_along(a, t, WayOut::Kind::neighbour, k, c));
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
    if (!t.is_ridge(k)) continue;
    const WayOut across = cross_ridge(a, t, k);
    if (across.separation > best.separation + tie) best = across;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const WayOut round = turn_round_corner(a, t, k);
    if (round.separation > best.separation + tie) best = round;
  }
  return best;
}

}  // namespace

Manifold collide_triangle_hull(const Shape& a, PlacedTriangle& t, double margin) {
  if (t.normal.dot(support(a, -t.normal) - t.corner[0]) > margin) return {};
  if (compute_distance(a, t.corner, Pose{}, {.beyond = margin}).lower > margin) return {};
  const TrianglePolytope flat(t.corner, t.normal);
  const Mat3 identity = Mat3::Identity();
  const Vec3 zero = Vec3::Zero();
  const Manifold met = collide_pieces({a, identity, zero}, {flat, identity, zero}, -t.normal, margin);
  if (met.count == 0) return {};
  t.place_neighbours();
  const bool behind = is_behind(a, t, t.normal);
  if (behind && t.is_at_rim()) return {};
  const Vec3 c = -met.normal_A;
  if (PlacedTriangle::same_direction(c, t.normal))
    return behind ? Manifold() : lie_on_triangle(a, t, met, margin);
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.bend[k] == Bend::convex && PlacedTriangle::same_direction(c, t.beyond_normal[k])) return {};
  }
  if (t.allows_about(c)) return is_behind(a, t, c) ? Manifold() : met;
  if (t.corner_yields(t.top(c), c)) return {};
  // The shortest way out of the flat triangle is none out of the surface.
  const WayOut way = find_way_out(a, t);
  if (way.separation > margin || way.kind == WayOut::Kind::neighbour || is_behind(a, t, way.c)) return {};
  if (way.kind == WayOut::Kind::own) return lie_on_triangle(a, t, met, margin);
  const std::uint32_t name =
      way.kind == WayOut::Kind::corner
          ? name_vertex(false, t.vertex[way.place])
          : name_crossing(0, 0, t.vertex[way.place], t.vertex[PlacedTriangle::next(way.place)]);
  return single_point(-way.c, way.p_body - 0.5 * way.separation * way.c, way.separation, margin, name);
}

}  // namespace tumble
