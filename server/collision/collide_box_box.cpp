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
  const auto bit = [&](int k) { return static_cast<std::uint32_t>(!std::signbit(d[k])) << k; };
  const std::uint32_t along = 1u << i, tail = (bit(0) | bit(1) | bit(2)) & ~along;
  // By a product: what is written into one coordinate of three has to be waited for.
  return {furthest_corner(h, d).cwiseProduct(Vec3::Ones() - Vec3::Unit(i)), tail, tail | along};
}

/// Edges of A and B that cross along an axis, in A's frame.
struct CrossingEdges {
  CrossingEdges(const BoxPair& boxes, const BoxAxis& axis, const FacingFaces& faces)
      : pair(boxes),
        i(axis.i),
        j(axis.j),
        edge_a(edge_along(pair.a, i, faces.normal_A)),
        edge_b(edge_along(pair.b, j, faces.towards_a_B)),
        centre_b(pair.t + pair.R * edge_b.centre) {}
  Segment a() const { return {edge_a.centre, pair.a[i] * Vec3::Unit(i)}; }
  Segment b() const { return {centre_b, pair.b[j] * pair.R.col(j)}; }
  std::uint32_t name() const { return name_crossing(edge_a.tail, edge_a.head, edge_b.tail, edge_b.head); }

  const BoxPair& pair;
  int i, j;
  BoxEdge edge_a, edge_b;
  Vec3 centre_b;
};

/// sin^2 of the angle from which on edges cross in one point, whatever the tolerances.
constexpr double kCrossing = 1e-2;

Manifold cross_edges(const BoxPair& pair, const BoxAxis& axis, const FacingFaces& faces, double margin) {
  const CrossingEdges edges(pair, axis, faces);
  // Where lines cross, a + s e_i and b + t r_j with e_i . r_j = cosine, their distance is the axis' separation.
  const Vec3 d = edges.centre_b - edges.edge_a.centre, along_b = pair.R.col(axis.j);
  const double cosine = pair.R(axis.i, axis.j), sine2 = 1.0 - cosine * cosine, along = d.dot(along_b);
  const double s = d[axis.i] - cosine * along, t = cosine * d[axis.i] - along;
  if (sine2 > kCrossing && std::abs(s) <= pair.a[axis.i] * sine2 && std::abs(t) <= pair.b[axis.j] * sine2) {
    const double half = 0.5 / sine2;
    const Vec3 middle_A =
        0.5 * (edges.edge_a.centre + edges.centre_b) + (half * t) * along_b + (half * s) * Vec3::Unit(axis.i);
    return single_point(faces.normal_A, middle_A, axis.separation, margin, edges.name());
  }
  const ContactTolerance tolerance = ContactTolerance::of(std::min(pair.a.minCoeff(), pair.b.minCoeff()));
  return make_segment_manifold({edges.a(), 0.0}, {edges.b(), 0.0}, faces.normal_A, margin, tolerance.merge,
                               edges.name());
}

Manifold make_manifold(const BoxPair& pair, const BoxAxis& axis, const FacingFaces& faces, double margin) {
  const bool flat_a = faces.a.cosine > ContactTolerance::kFlat,
             flat_b = faces.b.cosine > ContactTolerance::kFlat;
  if (axis.kind == BoxAxis::Kind::edges && !(flat_a || flat_b)) return cross_edges(pair, axis, faces, margin);
  return clip_faces(pair, faces, axis.separation, axis.kind == BoxAxis::Kind::face_a || flat_a, margin);
}

/// How far the lowest corner of a contact along a face's normal lies beside that face; how far edges miss each other.
void measure_overhang(const BoxPair& pair, const BoxAxis& axis, const FacingFaces& faces,
                      AxisContact& contact) {
  if (axis.kind == BoxAxis::Kind::edges) {
    const CrossingEdges edges(pair, axis, faces);
    contact.overhang = distance_between(edges.a(), edges.b()) - axis.separation;
    contact.tilt = 1.0;
    return;
  }
  const auto beside = [](const Vec3& p, const Vec3& h, int k) {
    const int k1 = next_axis(k), k2 = next_axis(k1);
    return std::max(std::abs(p[k1]) - h[k1], std::abs(p[k2]) - h[k2]);
  };
  const auto sine = [](const Vec3& n, int k) {
    const int k1 = next_axis(k), k2 = next_axis(k1);
    return std::sqrt(n[k1] * n[k1] + n[k2] * n[k2]);
  };
  if (axis.kind == BoxAxis::Kind::face_a) {
    contact.overhang =
        beside(pair.t + pair.R * furthest_corner(pair.b, faces.towards_a_B), pair.a, faces.a.k);
    contact.tilt = sine(faces.towards_a_B, faces.b.k);
  } else {
    const Vec3 corner = furthest_corner(pair.a, faces.normal_A);
    contact.overhang = beside(pair.R.transpose() * (corner - pair.t), pair.b, faces.b.k);
    contact.tilt = sine(faces.normal_A, faces.a.k);
  }
}

/// The contact along the axis that separates most, by at most the margin.
Manifold touch_along(const BoxPair& pair, const BoxAxis& axis, FacingFaces& faces, const Pose& X_AB,
                     double margin, PairCache& cache) {
  Manifold manifold = make_manifold(pair, axis, faces, margin);
  AxisContact contact{manifold, axis.separation, pair.size, faces.lie_face_to_face()};
  if (contact.separation > 0.0 && contact.face_to_face) measure_overhang(pair, axis, faces, contact);
  if (touches_along_axis(contact)) return manifold;
  const ClosestContact closest =
      contact_of_closest_points(contact, Box{pair.a}, Box{pair.b}, X_AB, margin, cache);
  if (closest.lying) {
    faces.see_along(pair, closest.manifold.normal_A);
    BoxAxis across = axis;
    across.separation = closest.separation;
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
  FacingFaces faces(pair, axis);
  cache.axis_A = faces.normal_A;
  cache.gap = axis.separation;
  if (axis.separation > margin) return {};
  return touch_along(pair, axis, faces, X_AB, margin, cache);
}

}  // namespace tumble
