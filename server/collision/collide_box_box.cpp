// Box against box in A's frame: fifteen axes, then a manifold. See collide_box_box.h.
#include "collision/collide_box_box.h"

#include <limits>
#include <utility>

#include "collision/clip.h"
#include "collision/corner_contact.h"
#include "collision/feature_name.h"
#include "collision/segment_contact.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// sin^2 of the angle between two edges below which their axis is evaluated with all six extents, since its unit axis is
/// rounded. Below kParallel it is no direction any more.
constexpr double kNearlyParallel = 1e-6;
/// Axes whose separations differ by less than this share of the sizes are equal but for rounding: the first one stays.
constexpr double kAxisTie = 1e-14;

/// a, b: half extents; R, t: pose of B in A; columns of R are B's axes.
struct BoxPair {
  Vec3 a, b, t;
  Mat3 R, R_abs;
};

struct Axis {
  enum class Kind { face_a, face_b, edges };
  double separation = -std::numeric_limits<double>::infinity();
  Vec3 normal_A = Vec3::UnitZ();  // unit, from A to B
  Kind kind = Kind::face_a;
  int i = 0, j = 0;  // edges: along axis i of A and j of B
};

Axis find_face_axis(const BoxPair& pair, double tie) {
  const Vec3 t_B = pair.R.transpose() * pair.t;
  const Vec3 a_axes = pair.t.cwiseAbs() - (pair.a + pair.R_abs * pair.b);
  const Vec3 b_axes = t_B.cwiseAbs() - (pair.b + pair.R_abs.transpose() * pair.a);
  int i = 0, j = 0;
  for (int k = 1; k < 3; ++k) {
    if (a_axes[k] > a_axes[i] + tie) i = k;
    if (b_axes[k] > b_axes[j] + tie) j = k;
  }
  if (b_axes[j] > a_axes[i] + tie) {
    return {b_axes[j], std::copysign(1.0, t_B[j]) * pair.R.col(j), Axis::Kind::face_b};
  }
  return {a_axes[i], std::copysign(1.0, pair.t[i]) * Vec3::Unit(i), Axis::Kind::face_a};
}

/// Separation along n = e_i x r_j / length, with |n . e_i| and |n . r_j| (zero but for rounding) counted if `honest`.
Axis evaluate_edge_axis(const BoxPair& pair, int i, int j, double length, bool honest) {
  const Vec3 n = Vec3::Unit(i).cross(pair.R.col(j)) / length;
  const double centre = n.dot(pair.t);
  double extents = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (k != i || honest) extents += pair.a[k] * std::abs(n[k]);
    if (k != j || honest) extents += pair.b[k] * std::abs(n.dot(pair.R.col(k)));
  }
  return {std::abs(centre) - extents, std::copysign(1.0, centre) * n, Axis::Kind::edges, i, j};
}

/// Whether scaled / sqrt(length2) > floor, without the root; may say yes within rounding.
bool may_exceed(double scaled, double length2, double floor) {
  const double square = scaled * scaled, floor2 = floor * floor * length2;
  return scaled < 0.0 ? floor < 0.0 && square <= floor2 * (1.0 + 1e-12)
                      : floor <= 0.0 || square >= floor2 * (1.0 - 1e-12);
}

/// Replaces `best` by the crossing of A's axis i with B's axis j if that separates more, and more than `at_least`.
template <int i, int j>
void try_edge_axis(const BoxPair& pair, double at_least, Axis& best) {
  constexpr int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  // e_i x r_j = (0, -R(i2, j), R(i1, j)) in the cyclic order of i; its products with r_j1, r_j2 are entries of R.
  const double length2 = pair.R(i1, j) * pair.R(i1, j) + pair.R(i2, j) * pair.R(i2, j);
  const double centre = pair.t[i2] * pair.R(i1, j) - pair.t[i1] * pair.R(i2, j);
  const double extents = pair.a[i1] * pair.R_abs(i2, j) + pair.a[i2] * pair.R_abs(i1, j) +
                         pair.b[j1] * pair.R_abs(i, j2) + pair.b[j2] * pair.R_abs(i, j1);
  const bool honest = length2 < kNearlyParallel;
  if (!honest && !may_exceed(std::abs(centre) - extents, length2, std::max(best.separation, at_least)))
    return;
  if (length2 < kParallel) return;
  const Axis axis = evaluate_edge_axis(pair, i, j, std::sqrt(length2), honest);
  if (axis.separation > best.separation) best = axis;
}

/// The best of the nine crossings, or the first beyond the margin.
Axis find_edge_axis(const BoxPair& pair, double margin, double at_least) {
  Axis best;
  const auto try_all = [&]<int... k>(std::integer_sequence<int, k...>) {
    (void)(... || (try_edge_axis<k / 3, k % 3>(pair, at_least, best), best.separation > margin));
  };
  try_all(std::make_integer_sequence<int, 9>{});
  return best;
}

/// The face of a box that looks along d most: across axis k, on the side `sign`. Corners of a box are numbered by the
/// signs of their coordinates: bit k is set on the positive side of axis k.
struct BoxFace {
  int k;
  double sign, cosine;

  static BoxFace towards(const Vec3& d) {
    int k = 0;
    const double cosine = d.cwiseAbs().maxCoeff(&k);
    return {k, std::copysign(1.0, d[k]), cosine};
  }
  double width(const Vec3& h) const { return std::min(h[(k + 1) % 3], h[(k + 2) % 3]); }
};

bool lie_face_to_face(const BoxFace& face_a, const BoxFace& face_b) {
  return std::min(face_a.cosine, face_b.cosine) > ContactTolerance::kFaceToFace;
}

/// The plane of a box's face in the box's frame: x, y along the box's axes k + 1 and k + 2 (cyclic), z outward; as
/// FacePlane, but its axes need no products.
struct BoxFacePlane {
  BoxFacePlane(const BoxFace& face, const Vec3& h, const Vec3& n)
      : k(face.k), k1((k + 1) % 3), k2((k + 2) % 3), height(face.sign * h[k]), n(n), per_n(1.0 / n[k]) {}

  /// Of the difference of two points; of a point, less the face's height along k.
  Vec3 to_plane(const Vec3& d) const {
    const double z = d[k] * per_n;
    return {d[k1] - z * n[k1], d[k2] - z * n[k2], z};
  }
  /// The middle between such a point and its foot on the plane.
  Vec3 middle(const Vec3& p) const {
    Vec3 middle = (0.5 * p.z()) * n;
    middle[k] += height;
    middle[k1] += p.x();
    middle[k2] += p.y();
    return middle;
  }

  int k, k1, k2;
  double height;
  Vec3 n;  ///< Contact normal away from the box, unit, near the face's.
  double per_n;
};

/// The incident box's face `face` over the plane; R, t: pose of that box in the reference's frame, h its half extents.
void add_face(const BoxFacePlane& plane, const BoxFace& face, const Mat3& R, const Vec3& t, const Vec3& h,
              ClipPolygon& polygon) {
  const int k = face.k, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  Vec3 centre = t + (face.sign * h[k]) * R.col(k);
  centre[plane.k] -= plane.height;
  const Vec3 middle = plane.to_plane(centre);
  // Counter-clockwise from outside.
  const Vec3 e1 = plane.to_plane(face.sign * h[k1] * R.col(k1)), e2 = plane.to_plane(h[k2] * R.col(k2));
  const bool up = face.sign > 0.0;
  const std::uint32_t side = up ? 1u << k : 0u, bit1 = 1u << k1, bit2 = 1u << k2;
  const std::uint32_t first = up ? side : side | bit1, second = first ^ bit1;
  polygon.add_vertex(middle - e1 - e2, first);
  polygon.add_vertex(middle + e1 - e2, second);
  polygon.add_vertex(middle + e1 + e2, second | bit2);
  polygon.add_vertex(middle - e1 + e2, first | bit2);
  polygon.close();
}

/// Cuts away what is not over the reference face.
void cut_by_face(const BoxFacePlane& plane, const BoxFace& face, const Vec3& h, double tolerance,
                 ClipPolygon& polygon) {
  const std::uint32_t bit1 = 1u << plane.k1, bit2 = 1u << plane.k2,
                      base = static_cast<std::uint32_t>(face.sign > 0.0) << plane.k;
  // In the order +x, +y, -x, -y, each from its lower to its upper corner as the loop runs for sign > 0.
  polygon.cut({1, 0, h[plane.k1], base | bit1, base | bit1 | bit2}, tolerance);
  polygon.cut({0, 1, h[plane.k2], base | bit1 | bit2, base | bit2}, tolerance);
  polygon.cut({-1, 0, h[plane.k1], base | bit2, base}, tolerance);
  polygon.cut({0, -1, h[plane.k2], base, base | bit1}, tolerance);
}

/// Clips B's face against A's or the other way round, whichever `reference_is_a` says, in the reference's frame.
Manifold clip_faces(const BoxPair& pair, const Axis& axis, const BoxFace& face_a, const BoxFace& face_b,
                    bool reference_is_a, double margin) {
  const double width = std::min(face_a.width(pair.a), face_b.width(pair.b));
  const ContactTolerance tolerance = ContactTolerance::of(width, lie_face_to_face(face_a, face_b));
  const bool overlap = axis.separation <= 0.0;
  ClipPolygon polygon(reference_is_a);
  if (reference_is_a) {
    const BoxFacePlane plane(face_a, pair.a, axis.normal_A);
    add_face(plane, face_b, pair.R, pair.t, pair.b, polygon);
    cut_by_face(plane, face_a, pair.a, tolerance.inside, polygon);
    const auto middle_A = [&](const Vec3& p) { return plane.middle(p); };
    return polygon.make_manifold(middle_A, axis.normal_A, overlap, margin, tolerance.merge);
  }
  const Mat3 R_BA = pair.R.transpose();
  const BoxFacePlane plane(face_b, pair.b, -(R_BA * axis.normal_A));
  add_face(plane, face_a, R_BA, -(R_BA * pair.t), pair.a, polygon);
  cut_by_face(plane, face_b, pair.b, tolerance.inside, polygon);
  const auto middle_A = [&](const Vec3& p) -> Vec3 { return pair.R * plane.middle(p) + pair.t; };
  return polygon.make_manifold(middle_A, axis.normal_A, overlap, margin, tolerance.merge);
}

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

Manifold cross_edges(const BoxPair& pair, const Axis& axis, double margin) {
  const BoxEdge a = edge_along(pair.a, Mat3::Identity(), Vec3::Zero(), axis.i, axis.normal_A);
  const BoxEdge b = edge_along(pair.b, pair.R, pair.t, axis.j, -axis.normal_A);
  const ContactTolerance tolerance = ContactTolerance::of(std::min(pair.a.minCoeff(), pair.b.minCoeff()));
  return make_segment_manifold({a.segment, 0.0}, {b.segment, 0.0}, axis.normal_A, margin, tolerance.merge,
                               name_crossing(a.tail, a.head, b.tail, b.head));
}

Manifold make_manifold(const BoxPair& pair, const Axis& axis, const BoxFace& face_a, const BoxFace& face_b,
                       double margin) {
  const bool flat_a = face_a.cosine > ContactTolerance::kFlat,
             flat_b = face_b.cosine > ContactTolerance::kFlat;
  if (axis.kind == Axis::Kind::edges && !(flat_a && flat_b)) return cross_edges(pair, axis, margin);
  return clip_faces(pair, axis, face_a, face_b, axis.kind == Axis::Kind::face_a || flat_a, margin);
}

/// The contact along the axis that separates most, by at most the margin.
Manifold touch_along(const BoxPair& pair, const Axis& axis, const Pose& X_AB, double margin,
                     PairCache& cache) {
  const BoxFace face_a = BoxFace::towards(axis.normal_A);
  const BoxFace face_b = BoxFace::towards(pair.R.transpose() * -axis.normal_A);
  Manifold manifold = make_manifold(pair, axis, face_a, face_b, margin);
  if (!touches_along_axis(manifold, axis.separation, pair.a.norm() + pair.b.norm())) {
    manifold = contact_of_closest_points(manifold, axis.separation, lie_face_to_face(face_a, face_b),
                                         Box{pair.a}, Box{pair.b}, X_AB, margin, cache);
  }
  return manifold;
}

}  // namespace

Manifold collide_box_box(const Box& a, const Box& b, const Pose& X_AB, double margin, PairCache& cache) {
  const Mat3 R = rotation_matrix(X_AB.q);
  const BoxPair pair{a.half_extents, b.half_extents, X_AB.p, R, R.cwiseAbs()};
  const double tie = kAxisTie * (pair.a.sum() + pair.b.sum());

  Axis best = find_face_axis(pair, tie);
  if (best.separation <= margin) {
    const Axis edge = find_edge_axis(pair, margin, best.separation + tie);
    if (edge.separation > best.separation + tie) best = edge;
  }
  cache.axis_A = best.normal_A;
  cache.gap = best.separation;
  if (best.separation > margin) return {};
  return touch_along(pair, best, X_AB, margin, cache);
}

}  // namespace tumble
