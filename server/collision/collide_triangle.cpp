// The separation along a direction c (out of the surface) is maximised over the directions in which the triangle is
// locally the surface's top: its own normal; the arcs of normals around its ridges; the cones around its peaks. Candidates
// are the triangle's normal, faces of the body, crossings of edges, and for round bodies the lines between closest
// features. Directions that only lead to a neighbour's normal are left to the neighbour. Everything in A's frame.
#include "collision/collide_triangle.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "collision/box_polytope.h"
#include "collision/clip.h"
#include "collision/collide_triangle_hull.h"
#include "collision/distance.h"
#include "collision/feature_name.h"
#include "collision/point_heights.h"
#include "collision/polytope.h"
#include "collision/segment_contact.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// Cosine above which a direction is the triangle's own normal: what differs is rounding.
constexpr double kSameNormal = 1.0 - 2e-16;
/// Rounding of a height, as part of the size.
constexpr double kHeightRounding = 64.0 * std::numeric_limits<double>::epsilon();
/// Axes whose separations differ by less than this share of the sizes are equal but for rounding: the first one stays.
constexpr double kDirectionTie = 1e-14;
/// Sine by which a face may lean and still count as level: no rounding is as large.
constexpr double kLevelFace = 1e-9;

/// A direction and the features that meet along it.
struct TriangleMeeting {
  enum class Kind { own_face, neighbour, body_face, edges, vertex };
  Kind kind = Kind::own_face;
  double separation = -kInfinity;  // of the cores
  Vec3 c = Vec3::UnitZ();
  std::uint32_t body = 0;                                 // face, edge or vertex of the body
  std::size_t edge = 0;                                   // edge or corner of the triangle
  Vec3 p_body = Vec3::Zero(), p_triangle = Vec3::Zero();  // of kind vertex: the points that meet
};

class TriangleQuery {
 public:
  TriangleQuery(const Shape& body, const Polytope& core, double radius, PlacedTriangle& triangle,
                double margin)
      : body_(body), core_(core), radius_(radius), enough_(margin + radius), margin_(margin), t_(triangle) {
    double size2 = 0.0;
    for (std::size_t k = 0; k < 3; ++k) size2 = std::max(size2, t_.along(k).squaredNorm());
    tie_ = kDirectionTie * (core.radius + radius + std::sqrt(size2));
  }

  Manifold run() {
    if (!meet_own_face() || is_kept_away()) return {};
    t_.place_neighbours();
    if (best_.kind == TriangleMeeting::Kind::neighbour && t_.is_at_rim()) return {};
    meet_body_faces();
    meet_neighbours();
    for (std::size_t k = 0; k < 3; ++k) {
      if (t_.is_ridge(k)) meet_edges(k);
    }
    if (core_.faces.empty()) meet_points();
    if (best_.separation > enough_) return {};
    if (best_.kind != TriangleMeeting::Kind::own_face && is_behind(best_.c, lowest(best_.c))) return {};
    if (yields()) return {};
    const Manifold manifold = touch_along_best();
    return core_.faces.empty() || is_whole_truth(manifold) ? manifold : touch_closest(manifold);
  }

 private:
  Manifold touch_along_best() const {
    const bool is_flat = best_.c.dot(t_.normal) > ContactTolerance::kFlat;
    switch (best_.kind) {
      case TriangleMeeting::Kind::neighbour:
        return {};
      case TriangleMeeting::Kind::own_face:
        return lie_on_triangle(best_.c);
      case TriangleMeeting::Kind::body_face:
        return lie_on_body();
      case TriangleMeeting::Kind::edges:
        return is_flat ? lie_across_edge() : cross_edges();
      case TriangleMeeting::Kind::vertex:
        break;
    }
    const double separation = best_.separation - radius_;
    const Vec3 middle = 0.5 * (best_.p_triangle + best_.p_body - radius_ * best_.c);
    return single_point(-best_.c, middle, separation, margin_, best_.body);
  }

  /// Whether what touches along the best axis is as near as that says, or overlaps.
  bool is_whole_truth(const Manifold& manifold) const {
    if (manifold.count == 0) return false;
    return best_.separation < -tie_ || least_separation(manifold) <= best_.separation + tie_;
  }

  /// Corners that look at each other, with no face or pair of edges between: the closest points, if the surface may push
  /// along the way between them. Else what was found along the best axis.
  Manifold touch_closest(const Manifold& along_axis) const {
    const Distance distance = compute_distance(body_, t_.corner, Pose{}, {.beyond = margin_});
    const Vec3 c = -distance.axis_A;
    if (distance.overlap || distance.lower > margin_ || !t_.allows_about(c)) return along_axis;
    // What lies over the triangle is known from clipping, and faces that lie on each other keep their polygon.
    if (PlacedTriangle::same_direction(c, t_.normal)) return along_axis;
    const double separation = lowest(c) - c.dot(t_.corner[t_.top(c)]);
    if (along_axis.count > 0 && c.dot(t_.normal) > ContactTolerance::kFaceToFace) {
      Manifold lying = lie_on_triangle(c);
      set_deepest(lying, separation);
      if (lying.count > 0) return lying;
    }
    return single_point(-c, 0.5 * (distance.a_A + distance.b_A), separation, margin_, name_corners());
  }

  double lowest(const Vec3& c) const { return descend(core_, c, 0, -kInfinity).height; }

  /// Whether the middle of the body is further in than the triangle, along c. `low`: the body's lowest height along it.
  bool is_behind(const Vec3& c, double low) const {
    return low - lowest(-c) < 2.0 * c.dot(t_.corner[t_.top(c)]);
  }

  /// False if the body is too high above the plane. One that is behind it may yet touch a ridge or a corner.
  bool meet_own_face() {
    best_.c = t_.normal;
    const double low = lowest(t_.normal);
    best_.separation = low - t_.normal.dot(t_.corner[0]);
    if (best_.separation > enough_) return false;
    if (is_behind(t_.normal, low)) best_.kind = TriangleMeeting::Kind::neighbour;
    return true;
  }

  /// What faces 4 i to 4 i + 3 of the body separate.
  Four separation_by_faces(std::size_t i) const {
    return smaller(smaller(heights_[0].four_from(i), heights_[1].four_from(i)), heights_[2].four_from(i));
  }

  /// Whether a face of the body keeps the triangle away, whether the surface may push along it or not.
  bool is_kept_away() {
    for (std::size_t k = 0; k < 3; ++k) heights_[k].measure(core_, t_.corner[k]);
    for (std::size_t i = 0; i < core_.face_fours.size(); ++i) {
      if (any(separation_by_faces(i) > four(enough_))) return true;
    }
    return false;
  }

  void meet_body_faces() {
    for (std::size_t i = 0; i < core_.face_fours.size(); ++i) {
      for_each_lane(separation_by_faces(i) > four(best_.separation), [&](std::size_t lane) {
        if (4 * i + lane < core_.faces.size()) meet_body_face(static_cast<std::uint32_t>(4 * i + lane));
      });
    }
  }

  /// Up to what a flat surface allows: there everything pushes along the normal to the last digit.
  bool is_own_normal(const Vec3& c) const {
    constexpr double kAsFlat = 4.0 * PlacedTriangle::kAlong;
    return (c - t_.normal).squaredNorm() <= kAsFlat * kAsFlat;
  }

  void meet_body_face(std::uint32_t i) {
    const Vec3& f = core_.faces[i].normal;
    const std::size_t top = t_.top(-f);
    const double separation = f.dot(t_.corner[top]) - core_.faces[i].offset;
    if (separation <= best_.separation + tie_ || is_own_normal(-f)) return;
    const bool is_own = t_.corner_allows(top, -f);
    if (!is_own && !t_.corner_yields(top, -f)) return;
    best_ = {.kind = is_own ? TriangleMeeting::Kind::body_face : TriangleMeeting::Kind::neighbour,
             .separation = separation,
             .c = -f,
             .body = i,
             .edge = top};
  }

  void meet_neighbours() {
    for (std::size_t k = 0; k < 3; ++k) {
      if (t_.bend[k] != Bend::convex) continue;
      const Vec3& c = t_.beyond_normal[k];
      const double separation = lowest(c) - c.dot(t_.corner[k]);
      if (separation > best_.separation) {
        best_ = {.kind = TriangleMeeting::Kind::neighbour, .separation = separation, .c = c, .edge = k};
      }
    }
  }

  /// Whether the normals of an edge's faces lie on both sides of the plane across a line, as good as: seen along the line it
  /// is part of the outline. `from` and `to`: heights of two points of the line; `level`: their distance times kLevelFace.
  bool is_rim(const Polytope::Edge& edge, const PointHeights& from, const PointHeights& to,
              double level) const {
    if (core_.faces.empty()) return true;
    const double left = to[edge.left_face] - from[edge.left_face],
                 right = to[edge.right_face] - from[edge.right_face];
    return !((left > level && right > level) || (left < -level && right < -level));
  }
  /// Whether such an edge is one of the body's upper side, if c is up.
  bool is_above(const Polytope::Edge& edge, const Vec3& along, const Vec3& c) const {
    if (core_.faces.empty()) return false;
    return outward_from_edge(along, core_.faces[edge.left_face].normal, core_.faces[edge.right_face].normal)
               .dot(c) > 0.0;
  }

  void meet_edges(std::size_t k) {
    const Vec3 own = t_.along(k);
    const Vec3 between = t_.normal + t_.normal_across(k);
    const double level = kLevelFace * own.norm();
    for (std::uint32_t i = 0; i < core_.edges.size(); ++i) {
      const Polytope::Edge& edge = core_.edges[i];
      if (!is_rim(edge, heights_[k], heights_[PlacedTriangle::next(k)], level)) continue;
      const Vec3& tail = core_.vertices[edge.tail];
      const Vec3 along = core_.vertices[edge.head] - tail, across = own.cross(along);
      const double length2 = across.squaredNorm(), sin2 = length2 / (own.squaredNorm() * along.squaredNorm());
      if (!(sin2 > kParallel)) continue;
      const double sign = across.dot(between) < 0.0 ? -1.0 : 1.0;
      if (is_above(edge, along, sign * across)) continue;
      const Vec3 c = across * (sign / std::sqrt(length2));
      const double offset = c.dot(t_.corner[k]);
      const double height = c.dot(tail) - offset;
      if (height <= best_.separation || !t_.edge_allows(k, c)) continue;
      const double separation = lowest(c) - c.dot(t_.corner[t_.top(c)]);
      if (height > separation + kHeightRounding * core_.radius) continue;  // another edge is the lowest
      if (separation <= best_.separation + tie_ || is_own_normal(c)) continue;
      best_ = {.kind = TriangleMeeting::Kind::edges, .separation = separation, .c = c, .body = i, .edge = k};
    }
  }

  /// Round bodies: their core's ends and, of a segment, its side against ridges and peaks.
  void meet_points() {
    const bool is_segment = core_.vertices.size() == 2;
    for (const Vec3& p : core_.vertices) {
      for (std::size_t k = 0; k < 3; ++k) {
        meet_corner(k, p);
        if (t_.bend[k] == Bend::flat || t_.bend[k] == Bend::concave) continue;
        const Vec3 side = t_.along(k);
        const double s = side.dot(p - t_.corner[k]) / side.squaredNorm();
        if (!(s > 0.0 && s < 1.0)) continue;
        const Vec3 foot = t_.corner[k] + s * side;
        consider(
            {.kind = is_segment ? TriangleMeeting::Kind::edges : TriangleMeeting::Kind::vertex,
             .body = is_segment ? 0 : name_crossing(0, 0, t_.vertex[k], t_.vertex[PlacedTriangle::next(k)]),
             .edge = k,
             .p_body = p,
             .p_triangle = foot},
            [&](const Vec3& c) { return t_.edge_allows(k, c); });
      }
    }
    if (!is_segment) return;
    const Segment core{0.5 * (core_.vertices[0] + core_.vertices[1]),
                       0.5 * (core_.vertices[1] - core_.vertices[0])};
    for (std::size_t k = 0; k < 3; ++k) {
      const double s = core.closest_parameter(t_.corner[k]);
      if (s > -1.0 && s < 1.0) meet_corner(k, core.at(s));
    }
  }

  void meet_corner(std::size_t k, const Vec3& p) {
    consider({.kind = TriangleMeeting::Kind::vertex,
              .body = name_vertex(false, t_.vertex[k]),
              .edge = k,
              .p_body = p,
              .p_triangle = t_.corner[k]},
             [&](const Vec3& c) { return t_.corner_allows(k, c); });
  }

  /// Takes the line between the two points if it separates most, is allowed, and the core has no lower point along it.
  template <typename Allows>
  void consider(TriangleMeeting meeting, Allows allows) {
    const Vec3 gap = meeting.p_body - meeting.p_triangle;
    meeting.separation = gap.norm();
    if (meeting.separation <= best_.separation || !(meeting.separation > 0.0)) return;
    meeting.c = gap / meeting.separation;
    if (meeting.c.dot(t_.normal) >= kSameNormal || !allows(meeting.c)) return;
    for (const Vec3& other : core_.vertices) {
      const Vec3 d = other - meeting.p_body;
      if (meeting.c.dot(d) < -PlacedTriangle::kAlong * d.norm()) return;
    }
    best_ = meeting;
  }

  /// Whether what is best belongs to another triangle.
  bool yields() const {
    if (best_.kind == TriangleMeeting::Kind::neighbour) return true;
    return best_.separation < 0.0 && yields_to_corners();
  }

  /// A body that overlaps may be nearer to the outside along a normal or an edge that the triangle has only a corner of: what
  /// wins in a corner's cone belongs to the triangles around it.
  bool yields_to_corners() const {
    const Vec3& low = core_.vertices[descend(core_, best_.c, 0, -kInfinity).vertex];
    for (std::size_t k = 0; k < 3; ++k) {
      if (yields_to_corner(k, low)) return true;
    }
    return false;
  }

  /// `low`: some point of the body that is low over the triangle.
  bool yields_to_corner(std::size_t k, const Vec3& low) const {
    std::array<Vec3, PlacedTriangle::kSpokes> spokes;
    const std::size_t count = t_.find_spokes(k, spokes);
    // Where nothing falls away from the triangle's plane the cone is its normal.
    const auto falls_away = [&](const Vec3& d) { return t_.normal.dot(d) < -kFlatBend * d.norm(); };
    const auto end = spokes.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::none_of(spokes.begin(), end, falls_away)) return false;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 across = spokes[i].cross(spokes[j]);
        if (is_way_out(k, low, across) || is_way_out(k, low, -across)) return true;
      }
      if (yields_to_spoke(k, low, spokes[i])) return true;
    }
    return false;
  }

  /// To an axis across an edge of the surface, which leaves corner k, and one of the body that is lowest there.
  bool yields_to_spoke(std::size_t k, const Vec3& low, const Vec3& spoke) const {
    PointHeights end;
    end.measure(core_, t_.corner[k] + spoke);
    const double level = kLevelFace * spoke.norm();
    for (const Polytope::Edge& edge : core_.edges) {
      if (!is_rim(edge, heights_[k], end, level)) continue;
      const Vec3 along = core_.vertices[edge.head] - core_.vertices[edge.tail], across = spoke.cross(along);
      for (const Vec3& c : {across, Vec3(-across)}) {
        if (!is_above(edge, along, c) && is_way_out(k, low, c)) return true;
      }
    }
    return false;
  }

  /// Whether the body is separated more along `across` (of any length), which is in the cone of corner k.
  bool is_way_out(std::size_t k, const Vec3& low, const Vec3& across) const {
    // Any one point of the body bounds the separation from above.
    const double needed = best_.separation + tie_, length2 = across.squaredNorm();
    const double reach = across.dot(low - t_.corner[k]);
    if (!(length2 > 0.0) || reach * std::abs(reach) < needed * std::abs(needed) * length2) return false;
    const Vec3 c = across / std::sqrt(length2);
    return lowest(c) - c.dot(t_.corner[k]) > needed && (t_.corner_allows(k, c) || t_.corner_yields(k, c));
  }

  /// The edges that are seams of a plane, as marks. What continues flatly is clipped by the neighbour too, and its corners
  /// are the same as without the seam: a corner that only seams make is none.
  std::uint32_t seams() const {
    std::uint32_t marks = 0;
    for (std::uint32_t k = 0; k < 3; ++k) marks |= t_.bend[k] == Bend::flat ? 1u << k : 0u;
    return marks;
  }

  Manifold collect(const ClipPolygon& polygon, const FacePlane& plane, const Vec3& normal_A,
                   double merge) const {
    ManifoldBuilder builder(normal_A, margin_, merge);
    for (int i = 0; i < polygon.count(); ++i) {
      auto [p, name, marks] = polygon.corner(i);
      if (marks != 0 && (marks & ~seams()) == 0) continue;
      p.z() -= radius_;
      builder.add(plane.middle_A(p), p.z(), name);
    }
    return builder.finish();
  }

  /// Edges that cross nearly in the triangle's plane: all that lies over it, measured along their axis.
  Manifold lie_across_edge() const {
    const Manifold crossing = cross_edges();
    if (crossing.count == 0) return crossing;
    Manifold lying = lie_on_triangle(best_.c);
    if (lying.count == 0) return crossing;
    set_deepest(lying, least_separation(crossing));
    return lying;
  }

  /// Along c, not far from the triangle's normal.
  Manifold lie_on_triangle(const Vec3& c) const {
    std::array<Polytope::Side, 3> sides;
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k] = make_side(t_.normal, t_.corner[k], t_.corner[PlacedTriangle::next(k)]);
    }
    const FaceAxes axes(t_.corner[0], t_.normal, sides[0]);
    const FacePlane plane(axes.origin(), axes.u(), t_.normal, c);
    ClipPolygon polygon(false);
    double width = t_.width();
    bool face_to_face = true;
    if (core_.faces.empty()) {
      for (std::uint32_t i = 0; i < core_.vertices.size(); ++i) {
        polygon.add_vertex(plane.to_plane(core_.vertices[i]), i);
      }
    } else {
      const Polytope::Face& face = core_.faces[face_towards(core_, -c)];
      const auto loop = core_.loop(face);
      const std::size_t count = std::min<std::size_t>(loop.size(), kMaxFaceVertices);
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t vertex = loop[k * loop.size() / count];
        polygon.add_vertex(plane.to_plane(core_.vertices[vertex]), vertex);
      }
      width = std::min(width, face.width);
      face_to_face = std::min(-face.normal.dot(c), t_.normal.dot(c)) > ContactTolerance::kFaceToFace;
    }
    polygon.close();
    const ContactTolerance tolerance = ContactTolerance::of(width);
    const double beside_ridge = std::max(face_to_face ? tolerance.inside : 0.0, tie_);
    for (std::size_t k = 0; k < 3; ++k) {
      ClipSide seam = axes.see(sides[k], t_.vertex[k], t_.vertex[PlacedTriangle::next(k)]);
      seam.mark = 1u << k;
      polygon.cut(seam, t_.is_ridge(k) ? beside_ridge : tolerance.inside);
    }
    return collect(polygon, plane, -c, tolerance.merge);
  }

  Manifold lie_on_body() const {
    const Polytope::Face& face = core_.faces[best_.body];
    const auto loop = core_.loop(face);
    const auto sides = core_.sides_of(face);
    const FaceAxes axes(core_.vertices[loop[0]], face.normal, sides[0]);
    const FacePlane plane(axes.origin(), axes.u(), face.normal, face.normal);
    ClipPolygon polygon(true);
    for (std::uint32_t k = 0; k < 3; ++k) {
      polygon.add_vertex(plane.to_plane(t_.corner[k]), t_.vertex[k], 1u << k);
    }
    polygon.close();
    const bool face_to_face = -face.normal.dot(t_.normal) > ContactTolerance::kFaceToFace;
    const ContactTolerance tolerance = ContactTolerance::of(std::min(face.width, t_.width()), face_to_face);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      polygon.cut(axes.see(sides[i], loop[i], loop[i + 1 == loop.size() ? 0 : i + 1]), tolerance.inside);
    }
    return collect(polygon, plane, face.normal, tolerance.merge);
  }

  Manifold cross_edges() const {
    const Polytope::Edge& edge = core_.edges[best_.body];
    const Vec3 &tail = core_.vertices[edge.tail], &head = core_.vertices[edge.head];
    const Segment a{0.5 * (tail + head), 0.5 * (head - tail)};
    const Segment b{0.5 * (t_.corner[best_.edge] + t_.corner[PlacedTriangle::next(best_.edge)]),
                    0.5 * t_.along(best_.edge)};
    const ContactTolerance tolerance = ContactTolerance::of(std::min(a.reach.norm(), b.reach.norm()));
    // The best of the allowed directions need not be one in which the two features meet.
    const SegmentPair closest = closest_points(a, b);
    const Vec3 gap = closest.p_A - closest.p_B;
    if ((gap - gap.dot(best_.c) * best_.c).norm() > tolerance.merge) return {};
    return make_segment_manifold({a, radius_}, {b, 0.0}, -best_.c, margin_, tolerance.merge,
                                 name_crossing(edge.tail, edge.head, t_.vertex[best_.edge],
                                               t_.vertex[PlacedTriangle::next(best_.edge)]));
  }

  const Shape& body_;
  const Polytope& core_;
  const double radius_, enough_, margin_;  // [m]
  PlacedTriangle& t_;
  double tie_;                           // [m]
  std::array<PointHeights, 3> heights_;  // of the triangle's corners over the body's faces
  TriangleMeeting best_;
};

}  // namespace

Manifold collide_triangle(const Shape& a, const TriangleSurface& b, std::uint32_t part, const Pose& X_AB,
                          double margin) {
  static constexpr std::array<std::uint32_t, 3> kPointOffsets = {0, 0, 0};
  static constexpr std::array<std::uint32_t, 3> kSegmentOffsets = {0, 1, 2};
  static constexpr std::array<std::uint32_t, 2> kSegmentNeighbours = {1, 0};
  static constexpr std::array<Polytope::Edge, 1> kSegmentEdges = {{{0, 1, 0, 0}}};
  PlacedTriangle triangle(b, part, X_AB);
  const auto query = [&](const Polytope& core, double radius) {
    return TriangleQuery(a, core, radius, triangle, margin).run();
  };
  if (const auto* sphere = std::get_if<Sphere>(&a)) {
    const std::array<Vec3, 1> centre = {Vec3::Zero()};
    FourVectors four;
    put_in_fours(centre, &four);
    return query({.vertices = centre, .neighbour_offsets = kPointOffsets, .vertex_fours = {&four, 1}},
                 sphere->radius);
  }
  if (const auto* capsule = std::get_if<Capsule>(&a)) {
    const std::array<Vec3, 2> ends = {Vec3(0, 0, -capsule->half_length), Vec3(0, 0, capsule->half_length)};
    FourVectors four;
    put_in_fours(ends, &four);
    return query({.vertices = ends,
                  .edges = kSegmentEdges,
                  .neighbour_offsets = kSegmentOffsets,
                  .neighbours = kSegmentNeighbours,
                  .vertex_fours = {&four, 1},
                  .radius = capsule->half_length},
                 capsule->radius);
  }
  if (const auto* box = std::get_if<Box>(&a)) {
    return query(BoxPolytope(*box), 0.0);
  }
  if (const auto* hull = std::get_if<HullPointer>(&a)) return query(**hull, 0.0);
  return is_static_only(a) ? Manifold{} : collide_triangle_hull(a, triangle, margin);
}

}  // namespace tumble
