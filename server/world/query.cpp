// See query.h.
#include "world/query.h"

#include <fmt/format.h>

#include <algorithm>

#include "collision/distance.h"
#include "collision/ray_cast.h"
#include "collision/shape_cast.h"
#include "collision/surface_query.h"
#include "world/check.h"

namespace tumble {
namespace {

Ray make_ray(const Vec3& origin, const Vec3& direction, double length) {
  check_finite("origin", origin);
  check_finite("direction", direction);
  if (direction.isZero(0.0)) refuse("direction: must not be zero (0 0 0)");
  if (!(length > 0.0)) refuse(fmt::format("length: must be > 0 ({})", length));
  return {origin, direction.stableNormalized(), length};
}

/// Half-spaces and surfaces are things to ask about, not to ask with.
void check_solid(const Shape& shape, const Pose& X_WS) {
  if (is_static_only(shape)) refuse(fmt::format("shape: a {} cannot be asked with", shape_name(shape)));
  const std::string problem = check_shape(shape);
  if (!problem.empty()) refuse(fmt::format("shape: {}", problem));
  check_pose("position", "orientation", X_WS);
}

BodyId body_of(const World& world, std::uint32_t geometry) {
  return world.id(world.geometries()[geometry].body);
}

bool accepts(const BodyFilter& filter, BodyId body) {
  return !filter || filter(body);
}

/// A hit before it gets its names.
struct GeometryHit {
  std::uint32_t geometry;  // the world's index; callers count by body
  double when;             // as the tree counts the way
  QueryHit hit;
  bool operator<(const GeometryHit& other) const {
    return when != other.when ? when < other.when : geometry < other.geometry;
  }
};

QueryHit named(const World& world, const GeometryHit& found) {
  QueryHit hit = found.hit;
  hit.body = body_of(world, found.geometry);
  const auto& own = world.body(hit.body.index).geometries;
  hit.geometry = static_cast<std::uint32_t>(std::find(own.begin(), own.end(), found.geometry) - own.begin());
  return hit;
}

std::optional<GeometryHit> cast_on_geometry(const World& world, std::uint32_t index, const Ray& ray) {
  const Geometry& geometry = world.geometries()[index];
  const Pose X_WS = world.geometry_pose(geometry);
  const Quat q_SW = X_WS.q.conjugate();
  const Ray ray_S{q_SW * (ray.origin - X_WS.p), q_SW * ray.direction, ray.length};
  const std::optional<RayHit> hit = cast_ray(geometry.shape, ray_S);
  if (!hit) return std::nullopt;
  return GeometryHit{index,
                     hit->distance,
                     {.fraction = hit->distance / ray.length,
                      .distance = hit->distance,
                      .p_W = ray.at(hit->distance),
                      .normal_W = X_WS.q * hit->normal,
                      .feature = hit->feature,
                      .inside = hit->inside}};
}

/// A shape on its way.
struct MovedShape {
  const Shape& shape;
  Pose X_WS;
  Vec3 way_W;
};

std::optional<GeometryHit> cast_on_geometry(const World& world, std::uint32_t index,
                                            const MovedShape& sweep) {
  const Geometry& geometry = world.geometries()[index];
  const Pose X_WG = world.geometry_pose(geometry);
  const std::optional<ShapeCastHit> hit = cast_shape(
      sweep.shape, geometry.shape, relative_pose(sweep.X_WS, X_WG), sweep.X_WS.q.conjugate() * sweep.way_W);
  if (!hit) return std::nullopt;
  return GeometryHit{index,
                     hit->fraction,
                     {.fraction = hit->fraction,
                      .distance = hit->fraction * sweep.way_W.norm(),
                      .p_W = sweep.X_WS * hit->p_A,
                      .normal_W = sweep.X_WS.q * hit->normal_A,
                      .inside = hit->inside}};
}

/// The first of all hits: the tree gives candidates with the earliest bounds first, and less and less of them.
template <typename Mover>
std::optional<QueryHit> find_first(const World& world, const Mover& mover, const Aabb& start,
                                   const Vec3& velocity, double limit, const BodyFilter& filter) {
  std::optional<GeometryHit> first;
  world.broad_phase().cast(start, velocity, limit, [&](std::uint32_t geometry) {
    if (!accepts(filter, body_of(world, geometry))) return limit;
    const std::optional<GeometryHit> hit = cast_on_geometry(world, geometry, mover);
    if (hit && (!first || *hit < *first)) {
      first = hit;
      limit = hit->when;
    }
    return limit;
  });
  if (!first) return std::nullopt;
  return named(world, *first);
}

/// Bodies of geometries whose bounds meet `bounds` and that pass the test, once each, in order of slots.
template <typename Test>
std::vector<BodyId> find_bodies(const World& world, const Aabb& bounds, const BodyFilter& filter, Test test) {
  std::vector<std::uint32_t> candidates;
  world.broad_phase().query(bounds, candidates);
  std::vector<BodyId> bodies;
  for (const std::uint32_t index : candidates) {
    const BodyId body = body_of(world, index);
    if (accepts(filter, body) && test(world.geometries()[index])) bodies.push_back(body);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return bodies;
}

std::optional<ClosestPoints> closest_of_overlap(const Geometry& a, const Pose& X_WA, const Geometry& b,
                                                const Pose& X_WB) {
  PairCache cache;
  NarrowPhaseCounters counters;
  const Manifold manifold = collide(a.shape, X_WA, b.shape, X_WB, 0.0, {}, cache, counters);
  if (manifold.count == 0) return std::nullopt;
  const auto& point = *std::min_element(
      manifold.points.begin(), manifold.points.begin() + manifold.count,
      [](const ManifoldPoint& p, const ManifoldPoint& q) { return p.separation < q.separation; });
  const Vec3 half_gap_A = 0.5 * point.separation * manifold.normal_A;
  return ClosestPoints{point.separation, X_WA * (point.p_A - half_gap_A), X_WA * (point.p_A + half_gap_A),
                       X_WA.q * manifold.normal_A};
}

ClosestPoints reversed(const ClosestPoints& points) {
  return {points.distance, points.p_WB, points.p_WA, -points.normal_W};
}

std::optional<ClosestPoints> closest_of_geometries(const World& world, const Geometry& a, const Geometry& b) {
  const Pose X_WA = world.geometry_pose(a), X_WB = world.geometry_pose(b);
  if (is_static_only(a.shape) && is_static_only(b.shape)) return std::nullopt;
  if (is_static_only(b.shape)) return reversed(*closest_of_geometries(world, b, a));
  if (std::holds_alternative<HalfSpace>(a.shape)) {
    const Vec3 n_W = X_WA.q * Vec3::UnitZ();
    const Vec3 lowest_W = X_WB * support(b.shape, X_WB.q.conjugate() * -n_W);
    const double height = n_W.dot(lowest_W - X_WA.p);
    return ClosestPoints{height, lowest_W - height * n_W, lowest_W, n_W};
  }
  const auto placed = [](const Distance& d, const Pose& X) {
    return ClosestPoints{d.upper, X * d.a_A, X * d.b_A, X.q * d.axis_A};
  };
  if (const TriangleSurface* surface = surface_of(a.shape)) {
    return reversed(placed(compute_distance(b.shape, *surface, relative_pose(X_WB, X_WA)), X_WB));
  }
  if (auto overlap = closest_of_overlap(a, X_WA, b, X_WB)) return overlap;
  return placed(compute_distance(a.shape, b.shape, relative_pose(X_WA, X_WB)), X_WA);
}

}  // namespace

std::optional<QueryHit> cast_ray(const World& world, const Vec3& origin, const Vec3& direction, double length,
                                 const BodyFilter& filter) {
  const Ray ray = make_ray(origin, direction, length);
  return find_first(world, ray, {origin, origin}, ray.direction, length, filter);
}

std::vector<QueryHit> cast_ray_through(const World& world, const Vec3& origin, const Vec3& direction,
                                       double length, const BodyFilter& filter) {
  const Ray ray = make_ray(origin, direction, length);
  std::vector<GeometryHit> found;
  world.broad_phase().cast({origin, origin}, ray.direction, length, [&](std::uint32_t geometry) {
    if (accepts(filter, body_of(world, geometry))) {
      if (const auto hit = cast_on_geometry(world, geometry, ray)) found.push_back(*hit);
    }
    return length;
  });
  std::sort(found.begin(), found.end());
  std::vector<QueryHit> hits;
  hits.reserve(found.size());
  for (const GeometryHit& hit : found) hits.push_back(named(world, hit));
  return hits;
}

std::optional<QueryHit> cast_shape(const World& world, const Shape& shape, const Pose& X_WS, const Vec3& way,
                                   const BodyFilter& filter) {
  check_solid(shape, X_WS);
  check_finite("way", way);
  return find_first(world, MovedShape{shape, X_WS, way}, compute_aabb(shape, X_WS), way, 1.0, filter);
}

std::vector<BodyId> find_overlapping(const World& world, const Shape& shape, const Pose& X_WS,
                                     const BodyFilter& filter) {
  check_solid(shape, X_WS);
  return find_bodies(world, compute_aabb(shape, X_WS), filter, [&](const Geometry& geometry) {
    if (const TriangleSurface* surface = surface_of(geometry.shape)) {
      return overlaps_surface(shape, *surface, relative_pose(X_WS, world.geometry_pose(geometry)));
    }
    PairCache cache;
    NarrowPhaseCounters counters;
    return collide(shape, X_WS, geometry.shape, world.geometry_pose(geometry), 0.0, {}, cache, counters)
               .count > 0;
  });
}

std::vector<BodyId> find_in_box(const World& world, const Aabb& box, const BodyFilter& filter) {
  if (!(box.lower.array() <= box.upper.array()).all()) {
    refuse(fmt::format("box: lower must be <= upper ({} {} {}, {} {} {})", box.lower.x(), box.lower.y(),
                       box.lower.z(), box.upper.x(), box.upper.y(), box.upper.z()));
  }
  return find_bodies(world, box, filter, [&](const Geometry& geometry) {
    return compute_aabb(geometry.shape, world.geometry_pose(geometry)).overlaps(box);
  });
}

std::optional<ClosestPoints> compute_closest_points(const World& world, BodyId a, BodyId b) {
  for (const BodyId id : {a, b}) {
    if (!world.is_valid(id)) {
      refuse(fmt::format("body: no such body (index {}, generation {})", id.index, id.generation));
    }
  }
  std::optional<ClosestPoints> closest;
  for (const std::uint32_t i : world.body(a.index).geometries) {
    for (const std::uint32_t j : world.body(b.index).geometries) {
      const auto points = closest_of_geometries(world, world.geometries()[i], world.geometries()[j]);
      if (points && (!closest || points->distance < closest->distance)) closest = points;
    }
  }
  return closest;
}

}  // namespace tumble
