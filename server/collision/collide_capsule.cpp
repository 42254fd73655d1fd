// Segment (A's core) against segment and polytope. While the core is outside, the distance decides: the nearest of its
// ends to faces and of the whole to edges. Inside, the separating axes do: face normals and edge x core.
#include "collision/collide_capsule.h"

#include <array>

#include "collision/box_polytope.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"
#include "collision/polytope.h"
#include "collision/segment_contact.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// Share of the radii below which two separations are equal: the rounding of one is a few 1e-16.
constexpr double kMeetingTie = 1e-15;
/// Faces whose heights are kept; those of larger hulls are computed again where needed.
constexpr std::size_t kKeptHeights = 512;
/// In place of an edge in Meeting.
constexpr std::uint32_t kNoFeature = 0xffffffffu;

/// Heights of the core over the polytope's faces: its centre's, and how much its end at +1 is higher.
class CoreHeights {
 public:
  struct Height {
    double centre, rise;
    double low() const { return centre - std::abs(rise); }
    double high() const { return centre + std::abs(rise); }
    double at(double s) const { return centre + s * rise; }
  };
  CoreHeights(const Polytope& polytope, const Segment& core) : polytope_(polytope), core_(core) {
    const std::size_t kept = std::min(polytope.faces.size(), kKeptHeights);
    for (std::size_t i = 0; i < kept; ++i) heights_[i] = compute(i);
  }
  Height operator[](std::size_t face) const { return face < kKeptHeights ? heights_[face] : compute(face); }

 private:
  Height compute(std::size_t i) const {
    const Polytope::Face& face = polytope_.faces[i];
    return {face.normal.dot(core_.centre) - face.offset, face.normal.dot(core_.reach)};
  }
  const Polytope& polytope_;
  const Segment& core_;
  std::array<Height, kKeptHeights> heights_;
};

/// Where the core meets the polytope, in the polytope's frame P; the normal points from the polytope to the core.
struct Meeting {
  double distance = -kInfinity;
  Vec3 normal_P = Vec3::UnitZ();
  std::uint32_t edge = kNoFeature;  ///< Or else a face.
  std::uint32_t face = 0;
};

/// The face that separates most, the first of equals.
Meeting find_face(const Polytope& polytope, const CoreHeights& heights, double tie) {
  Meeting best;
  for (std::uint32_t i = 0; i < polytope.faces.size(); ++i) {
    if (heights[i].low() > best.distance + tie) best.distance = heights[i].low(), best.face = i;
  }
  best.normal_P = polytope.faces[best.face].normal;
  return best;
}

/// The best axis across the core and an edge whose normals lie on both sides of the plane across the core. Edges whose
/// axes can't separate more than `needed` are left out: along the arc between two normals the overlap with any point of
/// the core is at least the smaller of its ends, as long as both are overlaps.
Meeting find_crossing(const Polytope& polytope, const Segment& core, const CoreHeights& heights,
                      double needed) {
  Meeting best;
  for (std::uint32_t i = 0; i < polytope.edges.size(); ++i) {
    const Polytope::Edge& edge = polytope.edges[i];
    const CoreHeights::Height left = heights[edge.left_face], right = heights[edge.right_face];
    if (left.rise * right.rise >= 0.0) continue;
    const double limit = std::min(0.0, std::max(needed, best.distance));
    if (std::max(left.at(1.0), right.at(1.0)) < limit || std::max(left.at(-1.0), right.at(-1.0)) < limit)
      continue;
    const Vec3& tail = polytope.vertices[edge.tail];
    const Vec3 along = polytope.vertices[edge.head] - tail;
    const Vec3 across = along.cross(core.reach);
    const double length2 = across.squaredNorm();
    if (length2 <= kParallel * along.squaredNorm() * core.reach.squaredNorm()) continue;
    const Vec3 outward = outward_from_edge(along, polytope.faces[edge.left_face].normal,
                                           polytope.faces[edge.right_face].normal);
    const double sign = across.dot(outward) < 0.0 ? -1.0 : 1.0;
    const Vec3 normal = across * (sign / std::sqrt(length2));
    const double height = normal.dot(core.centre - tail) - std::abs(normal.dot(core.reach));
    if (height > best.distance) best = {height, normal, i, 0};
  }
  return best;
}

/// How far the planes across n that touch the polytope and the core are apart: no distance is less.
double separation_along(const Polytope& polytope, const Segment& core, const Vec3& n) {
  return n.dot(core.centre) - std::abs(n.dot(core.reach)) + descend(polytope, -n, 0, -kInfinity).height;
}

/// The nearest place of a polytope to a core that is outside. An end of the core can only be nearest to the inside of the
/// face that it is highest over, since no distance is below a height; all else is edge against core. Places that are
/// equally near but for rounding may look along directions as different as its root: the one that separates more is it.
/// A distance up to the tie is no distance, and says nothing of the way.
Meeting find_closest(const Polytope& polytope, const Segment& core, const CoreHeights& heights, double tie) {
  Meeting best;
  best.distance = kInfinity;
  const auto is_better = [&](const Meeting& meeting) {
    if (std::abs(meeting.distance - best.distance) > tie) return meeting.distance < best.distance;
    return separation_along(polytope, core, meeting.normal_P) >
           separation_along(polytope, core, best.normal_P);
  };
  for (const double side : {-1.0, 1.0}) {
    std::uint32_t face = 0;
    for (std::uint32_t i = 1; i < polytope.faces.size(); ++i) {
      if (heights[i].at(side) > heights[face].at(side)) face = i;
    }
    const double height = heights[face].at(side);
    if (!(height > 0.0 && height < best.distance) || height_beside_face(polytope, face, core.at(side)) > 0.0)
      continue;
    best = {height, polytope.faces[face].normal, kNoFeature, face};
  }
  for (std::uint32_t i = 0; i < polytope.edges.size(); ++i) {
    const Polytope::Edge& edge = polytope.edges[i];
    const CoreHeights::Height left = heights[edge.left_face], right = heights[edge.right_face];
    if (std::max(left.low(), right.low()) >= best.distance + tie ||
        std::max(left.high(), right.high()) <= 0.0)
      continue;
    const Vec3 &tail = polytope.vertices[edge.tail], &head = polytope.vertices[edge.head];
    const Segment segment{0.5 * (tail + head), 0.5 * (head - tail)};
    const SegmentPair pair = closest_points(core, segment);
    const Vec3 apart = pair.p_A - pair.p_B;
    const double distance = apart.norm();
    if (distance <= tie) return {distance, best.normal_P, i, 0};
    const Meeting meeting{distance, direction_between(core, segment, pair, apart), i, 0};
    if (is_better(meeting)) best = meeting;
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

/// The part of the core that lies over the face along the normal, as up to two points. Named by the core's end, or by
/// the edge over which it leaves the face.
Manifold lie_on_face(const CapsuleQuery& q, std::uint32_t index, const Vec3& normal_P) {
  const Polytope::Face& face = q.polytope.faces[index];
  const ContactTolerance tolerance = ContactTolerance::of(face.width);
  struct End {
    double s;
    std::uint32_t name;
  };
  End low{-1.0, name_vertex(true, 0)}, high{1.0, name_vertex(true, 1)};
  bool over_face = true;
  const double slope = face.normal.dot(normal_P);
  const auto gap_at = [&](double s) { return (face.normal.dot(q.core_P.at(s)) - face.offset) / slope; };
  // The foot of the core on the face along the normal.
  const Vec3 reach = q.core_P.reach - (face.normal.dot(q.core_P.reach) / slope) * normal_P;
  const Vec3 centre = q.core_P.centre - gap_at(0.0) * normal_P;
  const auto loop = q.polytope.loop(face);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::uint32_t from = loop[i], to = loop[i + 1 == loop.size() ? 0 : i + 1];
    const Polytope::Side& side = q.polytope.sides[face.first + i];
    const double distance = side.outward.dot(centre) - side.offset, rise = side.outward.dot(reach);
    const double low_side = distance + low.s * rise, high_side = distance + high.s * rise;
    const bool low_out = low_side > tolerance.inside, high_out = high_side > tolerance.inside;
    over_face = over_face && !(low_out && high_out);
    const std::uint32_t name = name_crossing(0, 1, from, to);
    if (low_out) low = {high_side < 0.0 ? -distance / rise : high.s, name};
    if (high_out) high = {low_side < 0.0 ? -distance / rise : low.s, name};
  }
  ManifoldBuilder builder(q.X_AP.q * -normal_P, q.margin, tolerance.merge);
  if (over_face) {
    for (const End& end : {low, high}) {
      const double gap = gap_at(end.s);
      const Vec3 middle_P = q.core_P.at(end.s) - (0.5 * (gap + q.radius)) * normal_P;
      builder.add(q.X_AP * middle_P, gap - q.radius, end.name);
    }
  }
  return builder.finish();
}

Manifold meet_edge(const CapsuleQuery& q, const Meeting& meeting) {
  const Polytope::Edge& edge = q.polytope.edges[meeting.edge];
  const Vec3 tail = q.X_AP * q.polytope.vertices[edge.tail], head = q.X_AP * q.polytope.vertices[edge.head];
  const Segment segment{0.5 * (tail + head), 0.5 * (head - tail)};
  const Segment core{q.X_AP * q.core_P.centre, q.X_AP.q * q.core_P.reach};
  return make_segment_manifold({core, q.radius}, {segment, 0.0}, q.X_AP.q * -meeting.normal_P, q.margin,
                               ContactTolerance::of(segment.reach.norm()).merge,
                               name_crossing(0, 1, edge.tail, edge.head));
}

Manifold make_manifold(const CapsuleQuery& q, const Meeting& meeting) {
  std::uint32_t face = meeting.face;
  if (meeting.edge != kNoFeature) {
    face = flatter_face(q.polytope, q.polytope.edges[meeting.edge], meeting.normal_P);
  }
  Manifold manifold;
  if (q.polytope.faces[face].normal.dot(meeting.normal_P) > ContactTolerance::kFlat)
    manifold = lie_on_face(q, face, meeting.normal_P);
  if (manifold.count == 0 && meeting.edge != kNoFeature) manifold = meet_edge(q, meeting);
  set_deepest(manifold, meeting.distance - q.radius);
  return manifold;
}

Manifold collide_core(const CapsuleQuery& q, PairCache& cache) {
  const double enough = q.radius + q.margin;
  const double tie = kMeetingTie * (q.polytope.radius + q.radius + q.core_P.reach.norm());
  const auto remember = [&](const Meeting& meeting) {
    cache.axis_A = q.X_AP.q * -meeting.normal_P;
    cache.gap = meeting.distance - q.radius;
  };
  const CoreHeights heights(q.polytope, q.core_P);
  Meeting best = find_face(q.polytope, heights, tie);
  remember(best);
  if (best.distance > enough) return {};
  if (best.distance <= 0.0) {
    const Meeting crossing = find_crossing(q.polytope, q.core_P, heights, best.distance);
    if (crossing.distance > best.distance + tie) best = crossing;
  }
  if (best.distance > 0.0) {
    const Meeting closest = find_closest(q.polytope, q.core_P, heights, tie);
    if (closest.distance > tie) best = closest;
  }
  remember(best);
  return best.distance > enough ? Manifold{} : make_manifold(q, best);
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
  Manifold manifold =
      make_segment_manifold({core_a, a.radius}, {core_b, b.radius}, normal_A, margin, merge, 0);
  // Cores that cross at a small angle run side by side for the manifold: its ends may both be higher than the crossing.
  const double separation = distance - a.radius - b.radius;
  if (manifold.count == 0) {
    const Vec3 middle_A = 0.5 * (closest.p_A + closest.p_B + (a.radius - b.radius) * normal_A);
    return single_point(normal_A, middle_A, separation, margin, 0);
  }
  set_deepest(manifold, separation);
  return manifold;
}

Manifold collide_capsule_box(const Capsule& a, const Box& b, const Pose& X_AB, double margin,
                             PairCache& cache) {
  return collide_polytope(a, BoxPolytope(b), X_AB, margin, cache);
}

Manifold collide_capsule_hull(const Capsule& a, const HullPointer& b, const Pose& X_AB, double margin,
                              PairCache& cache) {
  return collide_polytope(a, *b, X_AB, margin, cache);
}

}  // namespace tumble
