// Box against box in A's frame: the best of fifteen axes, then a manifold. See collide_box_box.h.
#include "collision/collide_box_box.h"

#include <cmath>

#include "collision/box_axis.h"
#include "collision/box_faces.h"
#include "collision/corner_contact.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"
#include "collision/segment_contact.h"

namespace tumble {
namespace {

/// The edge of a box along axis `i` that reaches furthest along d, in the box's frame: its middle and its two corners.
struct BoxEdge {
  Vec3 centre;
  std::uint32_t tail, head;
};
BoxEdge edge_along(const Vec3& h, int i, const Vec3& d) {
  const int k = i == 2 ? 0 : i + 1, l = 3 - i - k;
  BoxEdge edge{Vec3::Zero(), 0, 0};
  edge.centre[k] = std::copysign(h[k], d[k]);
  edge.centre[l] = std::copysign(h[l], d[l]);
  edge.tail = static_cast<std::uint32_t>(!std::signbit(d[k])) << k |
              static_cast<std::uint32_t>(!std::signbit(d[l])) << l;
  edge.head = edge.tail | 1u << i;
  return edge;
}

/// Edges of A and B that cross along an axis, in A's frame. `towards_a_B` is the axis in B, from B to A.
struct CrossingEdges {
  CrossingEdges(const BoxPair& pair, const BoxAxis& axis, const Vec3& towards_a_B)
      : edge_a(edge_along(pair.a, axis.i, axis.normal_A)),
        edge_b(edge_along(pair.b, axis.j, towards_a_B)),
        centre_b(pair.t + pair.R * edge_b.centre),
        reach_a(pair.a[axis.i] * Vec3::Unit(axis.i)),
        reach_b(pair.b[axis.j] * pair.R.col(axis.j)) {}
  Segment a() const { return {edge_a.centre, reach_a}; }
  Segment b() const { return {centre_b, reach_b}; }
  std::uint32_t name() const { return name_crossing(edge_a.tail, edge_a.head, edge_b.tail, edge_b.head); }

  BoxEdge edge_a, edge_b;
  Vec3 centre_b, reach_a, reach_b;
};

/// sin^2 of the angle from which on edges cross in one point, whatever the tolerances.
constexpr double kCrossing = 1e-2;

Manifold cross_edges(const BoxPair& pair, const BoxAxis& axis, const Vec3& towards_a_B, double margin) {
  const CrossingEdges edges(pair, axis, towards_a_B);
  // Where lines cross, a + s e_i and b + t r_j with e_i . r_j = cosine, their distance is the axis' separation.
  const Vec3 d = edges.centre_b - edges.edge_a.centre, along_b = pair.R.col(axis.j);
  const double cosine = pair.R(axis.i, axis.j), sine2 = 1.0 - cosine * cosine, along = d.dot(along_b);
  const double s = d[axis.i] - cosine * along, t = cosine * d[axis.i] - along;
  if (sine2 > kCrossing && std::abs(s) <= pair.a[axis.i] * sine2 && std::abs(t) <= pair.b[axis.j] * sine2) {
    Vec3 middle_A = 0.5 * (edges.edge_a.centre + edges.centre_b + (t / sine2) * along_b);
    middle_A[axis.i] += 0.5 * (s / sine2);
    return single_point(axis.normal_A, middle_A, axis.separation, margin, edges.name());
  }
  const ContactTolerance tolerance = ContactTolerance::of(std::min(pair.a.minCoeff(), pair.b.minCoeff()));
  return make_segment_manifold({edges.a(), 0.0}, {edges.b(), 0.0}, axis.normal_A, margin, tolerance.merge,
                               edges.name());
}

/// The faces of A and B that look at each other along an axis.
struct FacingFaces {
  FacingFaces(const BoxPair& pair, const BoxAxis& axis)
      : towards_a_B(pair.R.transpose() * -axis.normal_A),
        a(BoxFace::towards(axis.normal_A)),
        b(BoxFace::towards(towards_a_B)) {}

  Vec3 towards_a_B;  ///< The axis in B, from B to A.
  BoxFace a, b;
};

Manifold make_manifold(const BoxPair& pair, const BoxAxis& axis, const FacingFaces& faces, double margin) {
  const bool flat_a = faces.a.cosine > ContactTolerance::kFlat,
             flat_b = faces.b.cosine > ContactTolerance::kFlat;
  if (axis.kind == BoxAxis::Kind::edges && !(flat_a || flat_b))
    return cross_edges(pair, axis, faces.towards_a_B, margin);
  return clip_faces(pair, axis, faces.a, faces.b, axis.kind == BoxAxis::Kind::face_a || flat_a, margin);
}

/// How far the lowest corner of a contact along a face's normal lies beside that face; how far edges miss each other.
void measure_overhang(const BoxPair& pair, const BoxAxis& axis, const FacingFaces& faces,
                      AxisContact& contact) {
  if (axis.kind == BoxAxis::Kind::edges) {
    const CrossingEdges edges(pair, axis, faces.towards_a_B);
    contact.overhang = distance_between(edges.a(), edges.b()) - axis.separation;
    contact.tilt = 1.0;
    return;
  }
  const auto beside = [](const Vec3& p, const Vec3& h, int k) {
    return std::max(std::abs(p[(k + 1) % 3]) - h[(k + 1) % 3], std::abs(p[(k + 2) % 3]) - h[(k + 2) % 3]);
  };
  const auto sine = [](const Vec3& n, int k) {
    return std::sqrt(n[(k + 1) % 3] * n[(k + 1) % 3] + n[(k + 2) % 3] * n[(k + 2) % 3]);
  };
  const Vec3 n_B = pair.R.transpose() * axis.normal_A;
  if (axis.kind == BoxAxis::Kind::face_a) {
    contact.overhang = beside(pair.t + pair.R * furthest_corner(pair.b, -n_B), pair.a, faces.a.k);
    contact.tilt = sine(n_B, faces.b.k);
  } else {
    const Vec3 corner = furthest_corner(pair.a, axis.normal_A);
    contact.overhang = beside(pair.R.transpose() * (corner - pair.t), pair.b, faces.b.k);
    contact.tilt = sine(axis.normal_A, faces.a.k);
  }
}

/// The contact along the axis that separates most, by at most the margin.
Manifold touch_along(const BoxPair& pair, const BoxAxis& axis, const Pose& X_AB, double margin,
                     PairCache& cache) {
  const FacingFaces faces(pair, axis);
  Manifold manifold = make_manifold(pair, axis, faces, margin);
  AxisContact contact{manifold, axis.separation, pair.a.norm() + pair.b.norm(),
                      lie_face_to_face(faces.a, faces.b)};
  if (contact.separation > 0.0 && contact.face_to_face) measure_overhang(pair, axis, faces, contact);
  if (touches_along_axis(contact)) return manifold;
  const ClosestContact closest =
      contact_of_closest_points(contact, Box{pair.a}, Box{pair.b}, X_AB, margin, cache);
  if (closest.lying) {
    const BoxAxis across{closest.separation, closest.manifold.normal_A, axis.kind, axis.i, axis.j};
    manifold = make_manifold(pair, across, faces, margin);
    set_deepest(manifold, closest.separation);
  } else {
    manifold = closest.manifold;
  }
  return manifold;
}

}  // namespace

Manifold collide_box_box(const Box& a, const Box& b, const Pose& X_AB, double margin, PairCache& cache) {
  const BoxPair pair(a, b, X_AB);
  const BoxAxis axis = find_axis(pair, margin);
  cache.axis_A = axis.normal_A;
  cache.gap = axis.separation;
  if (axis.separation > margin) return {};
  return touch_along(pair, axis, X_AB, margin, cache);
}

}  // namespace tumble
