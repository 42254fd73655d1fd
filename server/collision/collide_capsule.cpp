// Segment (A's core) against segment and polytope. While the core is outside, the distance decides: the nearest of its
// ends to faces and of the whole to edges. Inside, the separating axes do: face normals and edge x core.
#include "collision/collide_capsule.h"

#include <limits>

#include "collision/axis_preference.h"
#include "collision/clip.h"
#include "collision/feature_name.h"
#include "collision/polytope.h"
#include "collision/segment_contact.h"
#include "math/rotation.h"

namespace tumble {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// sin^2 of the angle between core and edge below which their common normal is noise.
constexpr double kParallel = 1e-24;
/// Cosine of 1e-3 rad: a core that crosses an edge with less tilt lies on the face (the error is 5e-7 of the radius).
constexpr double kFlat = 1.0 - 5e-7;

/// Where the core meets the polytope, in the polytope's frame P; the normal points from the polytope to the core.
struct Meeting {
  double distance = -kInfinity;
  Vec3 normal_P = Vec3::UnitZ();
  std::uint32_t index = 0;  // of the face or edge
};

Meeting find_face(const Polytope& polytope, const Segment& core, double enough, double preference) {
  Meeting best;
  for (std::uint32_t i = 0; i < polytope.faces.size(); ++i) {
    const ConvexHull::Face& face = polytope.faces[i];
    const double height = face.normal.dot(core.centre) - std::abs(face.normal.dot(core.reach)) - face.offset;
    if (height <= best.distance + preference) continue;
    best = {height, face.normal, i};
    if (height > enough) return best;
  }
  return best;
}

/// The best axis across the core and an edge whose normals lie on both sides of the plane across the core.
Meeting find_crossing(const Polytope& polytope, const Segment& core) {
  Meeting best;
  for (std::uint32_t i = 0; i < polytope.edges.size(); ++i) {
    const ConvexHull::Edge& edge = polytope.edges[i];
    const Vec3& left = polytope.faces[edge.left_face].normal;
    const Vec3& right = polytope.faces[edge.right_face].normal;
    if (left.dot(core.reach) * right.dot(core.reach) >= 0.0) continue;
    const Vec3& tail = polytope.vertices[edge.tail];
    const Vec3 along = polytope.vertices[edge.head] - tail;
    const Vec3 across = along.cross(core.reach);
    const double length2 = across.squaredNorm();
    if (length2 <= kParallel * along.squaredNorm() * core.reach.squaredNorm()) continue;
    const double sign = across.dot(left + right) < 0.0 ? -1.0 : 1.0;
    const Vec3 normal = across * (sign / std::sqrt(length2));
    const double height = normal.dot(core.centre - tail) - std::abs(normal.dot(core.reach));
    if (height > best.distance) best = {height, normal, i};
  }
  return best;
}

/// Closest features of a core that is outside. `index` is that of the edge, if an edge is nearest.
struct Closest {
  Meeting meeting;
  Vec3 foot_P, on_core_P;
  bool on_edge = false;
};

Closest find_closest(const Polytope& polytope, const Segment& core) {
  Closest best;
  best.meeting.distance = kInfinity;
  for (const double side : {-1.0, 1.0}) {
    const Vec3 end = core.at(side);
    const PointDistance near = compute_distance(polytope, end, best.meeting.distance);
    if (near.distance < best.meeting.distance) {
      best = {{near.distance, near.normal, near.feature}, near.foot, end, false};
    }
  }
  for (std::uint32_t i = 0; i < polytope.edges.size(); ++i) {
    const Vec3& tail = polytope.vertices[polytope.edges[i].tail];
    const Vec3& head = polytope.vertices[polytope.edges[i].head];
    const Segment edge{0.5 * (tail + head), 0.5 * (head - tail)};
    const SegmentPair pair = closest_points(core, edge);
    const Vec3 apart = pair.p_A - pair.p_B;
    const double distance = apart.norm();
    if (distance > 0.0 && distance < best.meeting.distance) {
      best = {{distance, apart / distance, i}, pair.p_B, pair.p_A, true};
    }
  }
  return best;
}

struct CapsuleQuery {
  const Polytope& polytope;
  Segment core_P;
  double radius;
  Pose X_AP;
  double margin;
};

/// The part of the core that lies over the face, as one or two points.
Manifold lie_on_face(const CapsuleQuery& q, const Meeting& meeting) {
  const ConvexHull::Face& face = q.polytope.faces[meeting.index];
  const ContactTolerance tolerance = ContactTolerance::of(face_width(q.polytope, face));
  double low = -1.0, high = 1.0;
  bool over_face = true;
  const auto loop = q.polytope.loop(face);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& tail = q.polytope.vertices[loop[i]];
    const Vec3 along = q.polytope.vertices[loop[i + 1 == loop.size() ? 0 : i + 1]] - tail;
    const Vec3 outward = direction_or(along.cross(face.normal), Vec3::Zero());
    const double centre = outward.dot(q.core_P.centre - tail), slope = outward.dot(q.core_P.reach);
    const double low_side = centre + low * slope, high_side = centre + high * slope;
    const bool low_out = low_side > tolerance.inside, high_out = high_side > tolerance.inside;
    over_face = over_face && !(low_out && high_out);
    if (low_out) low = high_side < 0.0 ? -centre / slope : high;
    if (high_out) high = low_side < 0.0 ? -centre / slope : low;
  }
  const Vec3 normal_A = q.X_AP.q * -face.normal;
  ManifoldBuilder builder(normal_A, q.margin, tolerance.merge);
  const auto add = [&](double s, std::uint32_t id) {
    const Vec3 p = q.core_P.at(s);
    const double height = face.normal.dot(p) - face.offset;
    builder.add(q.X_AP * (p - (0.5 * (height + q.radius)) * face.normal), height - q.radius,
                mix_features(meeting.index, id, 2));
  };
  if (over_face) {
    add(low, 0);
    add(high, 1);
  }
  if (builder.count() == 0) add(face.normal.dot(q.core_P.reach) > 0.0 ? -1.0 : 1.0, 2);
  return builder.finish();
}

Manifold lie_on_edge(const CapsuleQuery& q, const Vec3& normal_P, std::uint32_t index) {
  const Vec3 tail = q.X_AP * q.polytope.vertices[q.polytope.edges[index].tail];
  const Vec3 head = q.X_AP * q.polytope.vertices[q.polytope.edges[index].head];
  const Segment edge{0.5 * (tail + head), 0.5 * (head - tail)};
  const Segment core{q.X_AP * q.core_P.centre, q.X_AP.q * q.core_P.reach};
  const double merge = ContactTolerance::of(edge.reach.norm()).merge;
  return make_segment_manifold({core, q.radius}, {edge, 0.0}, q.X_AP.q * -normal_P, q.margin, merge,
                               mix_features(index, 0, 3));
}

Manifold collide_core(const CapsuleQuery& q, PairCache& cache) {
  const double enough = q.radius + q.margin;
  const AxisPreference preference = AxisPreference::of(std::min(q.polytope.radius, q.radius));
  const auto remember = [&](const Meeting& meeting) {
    cache.axis_A = q.X_AP.q * -meeting.normal_P;
    cache.gap = meeting.distance - q.radius;
  };
  const Meeting face = find_face(q.polytope, q.core_P, enough, preference.face);
  remember(face);
  if (face.distance > enough) return {};
  const Meeting crossing = find_crossing(q.polytope, q.core_P);
  if (crossing.distance > enough) {
    remember(crossing);
    return {};
  }
  if (std::max(face.distance, crossing.distance) <= 0.0) {
    if (!preference.takes_edge(face.distance, face.normal_P, crossing.distance, crossing.normal_P, 1.0)) {
      return lie_on_face(q, face);
    }
    return lie_on_edge(q, crossing.normal_P, crossing.index);
  }
  const Closest closest = find_closest(q.polytope, q.core_P);
  const Meeting& nearest = closest.meeting;
  remember(nearest);
  if (nearest.distance > enough) return {};
  const bool lies_flat = closest.on_edge && nearest.normal_P.dot(face.normal_P) > kFlat;
  if (lies_flat || nearest.normal_P == face.normal_P) return lie_on_face(q, face);
  if (closest.on_edge) return lie_on_edge(q, nearest.normal_P, nearest.index);
  const double separation = nearest.distance - q.radius;
  const Vec3 middle_P = closest.foot_P + (0.5 * separation) * nearest.normal_P;
  return single_point(q.X_AP.q * -nearest.normal_P, q.X_AP * middle_P, separation, q.margin,
                      mix_features(nearest.index, 0, 4));
}

Manifold collide_polytope(const Capsule& a, const Polytope& b, const Pose& X_AB, double margin,
                          PairCache& cache) {
  const Pose X_BA = X_AB.inverse();
  return collide_core({b, {X_BA.p, X_BA.q * Vec3(0, 0, a.half_length)}, a.radius, X_AB, margin}, cache);
}

}  // namespace

Manifold collide_capsule_capsule(const Capsule& a, const Capsule& b, const Pose& X_AB, double margin) {
  const Segment core_a{Vec3::Zero(), Vec3(0, 0, a.half_length)};
  const Segment core_b{X_AB.p, X_AB.q * Vec3(0, 0, b.half_length)};
  const SegmentPair closest = closest_points(core_a, core_b);
  const Vec3 apart = closest.p_B - closest.p_A;
  const double distance = apart.norm(), reach = a.radius + b.radius + margin;
  if (distance > reach) return {};
  Vec3 normal_A = apart;
  if (distance > 0.0) {
    normal_A /= distance;
  } else {
    const Vec3 across = core_a.reach.cross(core_b.reach);
    normal_A = direction_or(across, perpendicular_to(core_a.reach));
  }
  const double merge = ContactTolerance::of(std::min(a.half_length, b.half_length)).merge;
  return make_segment_manifold({core_a, a.radius}, {core_b, b.radius}, normal_A, margin, merge, 0);
}

Manifold collide_capsule_box(const Capsule& a, const Box& b, const Pose& X_AB, double margin,
                             PairCache& cache) {
  const BoxFeatures box(b);
  return collide_polytope(a, box.view(), X_AB, margin, cache);
}

Manifold collide_capsule_hull(const Capsule& a, const HullPointer& b, const Pose& X_AB, double margin,
                              PairCache& cache) {
  return collide_polytope(a, view_of(*b), X_AB, margin, cache);
}

}  // namespace tumble
