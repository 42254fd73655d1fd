// Box against box in A's frame: the best of fifteen axes, then a manifold. See collide_box_box.h.
#include "collision/collide_box_box.h"

#include "collision/box_axis.h"
#include "collision/box_faces.h"
#include "collision/corner_contact.h"
#include "collision/feature_name.h"
#include "collision/manifold_builder.h"
#include "collision/segment_contact.h"

namespace tumble {
namespace {

/// The edge of a box along axis `i` that reaches furthest along n, with its two corners.
struct BoxEdge {
  Segment segment;
  std::uint32_t tail, head;
};
BoxEdge edge_along(const Vec3& h, const Mat3& R, const Vec3& centre, int i, const Vec3& n) {
  BoxEdge edge{{centre, h[i] * R.col(i)}, 0, 1u << i};
  for (const int k : {(i + 1) % 3, (i + 2) % 3}) {
    const bool positive = n.dot(R.col(k)) >= 0.0;
    edge.segment.centre += (positive ? h[k] : -h[k]) * R.col(k);
    edge.tail |= static_cast<std::uint32_t>(positive) << k;
  }
  edge.head |= edge.tail;
  return edge;
}

Manifold cross_edges(const BoxPair& pair, const BoxAxis& axis, double margin) {
  const BoxEdge a = edge_along(pair.a, Mat3::Identity(), Vec3::Zero(), axis.i, axis.normal_A);
  const BoxEdge b = edge_along(pair.b, pair.R, pair.t, axis.j, -axis.normal_A);
  const ContactTolerance tolerance = ContactTolerance::of(std::min(pair.a.minCoeff(), pair.b.minCoeff()));
  return make_segment_manifold({a.segment, 0.0}, {b.segment, 0.0}, axis.normal_A, margin, tolerance.merge,
                               name_crossing(a.tail, a.head, b.tail, b.head));
}

Manifold make_manifold(const BoxPair& pair, const BoxAxis& axis, const BoxFace& face_a, const BoxFace& face_b,
                       double margin) {
  const bool flat_a = face_a.cosine > ContactTolerance::kFlat,
             flat_b = face_b.cosine > ContactTolerance::kFlat;
  if (axis.kind == BoxAxis::Kind::edges && !(flat_a && flat_b)) return cross_edges(pair, axis, margin);
  return clip_faces(pair, axis, face_a, face_b, axis.kind == BoxAxis::Kind::face_a || flat_a, margin);
}

/// How far the lowest corner of a contact along a face's normal lies beside that face.
void measure_overhang(const BoxPair& pair, const BoxAxis& axis, const BoxFace& face_a, const BoxFace& face_b,
                      AxisContact& contact) {
  if (axis.kind == BoxAxis::Kind::edges) return;
  const auto beside = [](const Vec3& p, const Vec3& h, int k) {
    return std::max(std::abs(p[(k + 1) % 3]) - h[(k + 1) % 3], std::abs(p[(k + 2) % 3]) - h[(k + 2) % 3]);
  };
  const auto sine = [](const Vec3& n, int k) {
    return std::sqrt(n[(k + 1) % 3] * n[(k + 1) % 3] + n[(k + 2) % 3] * n[(k + 2) % 3]);
  };
  const Vec3 n_B = pair.R.transpose() * axis.normal_A;
  if (axis.kind == BoxAxis::Kind::face_a) {
    contact.overhang = beside(pair.t + pair.R * furthest_corner(pair.b, -n_B), pair.a, face_a.k);
    contact.tilt = sine(n_B, face_b.k);
  } else {
    const Vec3 corner = furthest_corner(pair.a, axis.normal_A);
    contact.overhang = beside(pair.R.transpose() * (corner - pair.t), pair.b, face_b.k);
    contact.tilt = sine(axis.normal_A, face_a.k);
  }
}

/// The contact along the axis that separates most, by at most the margin.
Manifold touch_along(const BoxPair& pair, const BoxAxis& axis, const Pose& X_AB, double margin,
                     PairCache& cache) {
  const BoxFace face_a = BoxFace::towards(axis.normal_A);
  const BoxFace face_b = BoxFace::towards(pair.R.transpose() * -axis.normal_A);
  AxisContact contact{make_manifold(pair, axis, face_a, face_b, margin), axis.separation,
                      pair.a.norm() + pair.b.norm(), lie_face_to_face(face_a, face_b)};
  if (contact.separation > 0.0 && contact.face_to_face) measure_overhang(pair, axis, face_a, face_b, contact);
  if (touches_along_axis(contact)) return contact.manifold;
  const ClosestContact closest =
      contact_of_closest_points(contact, Box{pair.a}, Box{pair.b}, X_AB, margin, cache);
  if (!closest.lying) return closest.manifold;
  const BoxAxis across{closest.separation, closest.manifold.normal_A, axis.kind, axis.i, axis.j};
  Manifold polygon = make_manifold(pair, across, face_a, face_b, margin);
  set_deepest(polygon, closest.separation);
  return polygon;
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
