// Questions to the world between steps: what a ray or a moved shape meets, what lies in a place, how far two bodies are
// apart. Free functions over a const World. Every answer is decided by exact shapes at their present poses; the tree of
// the broad phase only saves looking at the rest, and gives the same bits as looking at everything. World frame, SI units.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "world/world.h"

namespace tumble {

/// Which bodies a query looks at; empty: all.
using BodyFilter = std::function<bool(BodyId)>;

struct QueryHit {
  BodyId body = {};
  std::uint32_t geometry = 0;    ///< Index among the body's geometries.
  double fraction = 0.0;         ///< Of the way, 0..1; 0 for an endless ray.
  double distance = 0.0;         ///< Along the way [m].
  Vec3 p_W = Vec3::Zero();       ///< Where they meet [m].
  Vec3 normal_W = Vec3::Zero();  ///< Unit, out of what was hit.
  std::uint32_t feature = 0;     ///< Ray: face or side that was hit, see RayHit; shape cast: 0.
  bool inside =
      false;  ///< The way starts inside; fraction is 0. Ray: normal is against it. Cast: the way out.
};

inline constexpr double kEndless = kInfinity;

/// What the ray meets first; of equal distances the older geometry. direction: any length > 0. length [m] > 0, may be
/// kEndless. A ray that starts inside a body meets it at once (filter the body out to look out of it). Throws
/// std::invalid_argument("field: reason (value)").
std::optional<QueryHit> cast_ray(const World& world, const Vec3& origin, const Vec3& direction,
                                 double length = kEndless, const BodyFilter& filter = {});
/// Every geometry that the ray meets, the nearest first, each once.
std::vector<QueryHit> cast_ray_through(const World& world, const Vec3& origin, const Vec3& direction,
                                       double length = kEndless, const BodyFilter& filter = {});

/// What a convex shape at X_WS meets first when it is moved by `way` [m] without turning. However thin, nothing is passed.
/// What it only touches at the start and is not moved into does not count. Throws for half-spaces, surfaces and bad values.
std::optional<QueryHit> cast_shape(const World& world, const Shape& shape, const Pose& X_WS, const Vec3& way,
                                   const BodyFilter& filter = {});

/// Bodies that share a point with the convex shape at X_WS, in order of their slots. Throws likewise.
std::vector<BodyId> find_overlapping(const World& world, const Shape& shape, const Pose& X_WS,
                                     const BodyFilter& filter = {});
/// Bodies of which some geometry's tight axis-aligned bounds share a point with the box, in order of their slots.
std::vector<BodyId> find_in_box(const World& world, const Aabb& box, const BodyFilter& filter = {});

struct ClosestPoints {
  double distance = 0.0;         ///< [m]; < 0: overlap, by the depth of the deepest contact; 0 for surfaces.
  Vec3 p_WA = Vec3::Zero();      ///< On A.
  Vec3 p_WB = Vec3::Zero();      ///< On B.
  Vec3 normal_W = Vec3::Zero();  ///< Unit, from A to B.
};
/// None if one of them has no geometry, or both only half-spaces and surfaces. Throws for stale ids.
std::optional<ClosestPoints> compute_closest_points(const World& world, BodyId a, BodyId b);

}  // namespace tumble
