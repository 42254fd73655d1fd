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

/// sin^2 of the angle between two edges below which their axis is no direction any more. What lies between that and
/// kNearlyParallel is evaluated with all six extents, since its unit axis is rounded.
constexpr double kParallel = 1e-24, kNearlyParallel = 1e-6;
/// Axes whose separations differ by less than this share of the sizes are equal but for rounding: the first one stays.
constexpr double kTie = 1e-14;
/// Cosine of 0.1 rad. Edges that cross under faces as flat as this to their axis lie in a contact of these faces: it
/// keeps the faces' whole polygon of points, only measured along the edges' axis.
constexpr double kFlat = 0.995;

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

/// The best face axis, or, if `beyond` says so, one that separates by more than the margin.
Axis find_face_axis(const BoxPair& pair, double margin, double tie, bool& beyond) {
  const Vec3 t_B = pair.R.transpose() * pair.t;
  const Vec3 a_axes = pair.t.cwiseAbs() - (pair.a + pair.R_abs * pair.b);
  const Vec3 b_axes = t_B.cwiseAbs() - (pair.b + pair.R_abs.transpose() * pair.a);
  int i = 0, j = 0;
  for (int k = 1; k < 3; ++k) {
    if (a_axes[k] > a_axes[i] + tie) i = k;
    if (b_axes[k] > b_axes[j] + tie) j = k;
  }
  Axis best;
  if (b_axes[j] > a_axes[i] + tie) {
    best = {b_axes[j], std::copysign(1.0, t_B[j]) * pair.R.col(j), Axis::Kind::face_b};
  } else {
    best = {a_axes[i], std::copysign(1.0, pair.t[i]) * Vec3::Unit(i), Axis::Kind::face_a};
  }
  beyond = best.separation > margin;
  return best;
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

/// The best of the nine crossings, or the first beyond the margin.
Axis find_edge_axis(const BoxPair& pair, double margin, double at_least, bool& beyond) {
  Axis best;
  beyond = false;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      // e_i x r_j = (0, -R(i2, j), R(i1, j)) in the cyclic order of i; its products with r_j1, r_j2 are entries of R.
      const double length2 = pair.R(i1, j) * pair.R(i1, j) + pair.R(i2, j) * pair.R(i2, j);
      if (length2 < kParallel) continue;
      const double centre = pair.t[i2] * pair.R(i1, j) - pair.t[i1] * pair.R(i2, j);
      const double extents = pair.a[i1] * pair.R_abs(i2, j) + pair.a[i2] * pair.R_abs(i1, j) +
                             pair.b[j1] * pair.R_abs(i, j2) + pair.b[j2] * pair.R_abs(i, j1);
      const double scaled = std::abs(centre) - extents;
      const bool honest = length2 < kNearlyParallel;
      const double floor = std::max(best.separation, at_least);
      // Compare without the square root: scaled / length > floor.
      if (!honest &&
          (scaled < 0.0 ? floor >= 0.0 || scaled * scaled > floor * floor * length2 * (1.0 + 1e-12)
                        : floor > 0.0 && scaled * scaled < floor * floor * length2 * (1.0 - 1e-12))) {
        continue;
      }
      const Axis axis = evaluate_edge_axis(pair, i, j, std::sqrt(length2), honest);
      if (axis.separation <= best.separation) continue;
      best = axis;
      beyond = best.separation > margin;
      if (beyond) return best;
    }
  }
  return best;
}

/// Corners of a box are numbered by the signs of their coordinates: bit k is set on the positive side of axis k.
Vec3 box_corner(const Vec3& h, std::uint32_t corner) {
  return {corner & 1 ? h.x() : -h.x(), corner & 2 ? h.y() : -h.y(), corner & 4 ? h.z() : -h.z()};
}

/// The face of a box that looks along d most: across axis k, on the side `sign`.
struct BoxFace {
  int k;
  double sign, cosine;

  static BoxFace towards(const Vec3& d) {
    int k = 0;
    const double cosine = d.cwiseAbs().maxCoeff(&k);
    return {k, std::copysign(1.0, d[k]), cosine};
  }
  /// Corner i = 0..3, counter-clockwise from outside.
  std::uint32_t corner(int i) const {
    const std::uint32_t first = sign > 0.0 ? i == 1 || i == 2 : i == 0 || i == 3, second = i >= 2;
    return first << (k + 1) % 3 | second << (k + 2) % 3 | static_cast<std::uint32_t>(sign > 0.0) << k;
  }
};

bool lie_face_to_face(const BoxFace& face_a, const BoxFace& face_b) {
  return std::min(face_a.cosine, face_b.cosine) > ContactTolerance::kFaceToFace;
}

/// Clips B's face against A's or the other way round, whichever `reference_is_a` says.
Manifold clip_faces(const BoxPair& pair, const Axis& axis, const BoxFace& face_a, const BoxFace& face_b,
                    bool reference_is_a, double margin) {
  const BoxFace& reference = reference_is_a ? face_a : face_b;
  const BoxFace& incident = reference_is_a ? face_b : face_a;
  const Vec3& h = reference_is_a ? pair.a : pair.b;
  const Vec3& h_incident = reference_is_a ? pair.b : pair.a;
  const int k = reference.k, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  FacePlane plane;
  if (reference_is_a) {
    plane = {Vec3::Unit(k) * (reference.sign * h[k]), Vec3::Unit(k1), Vec3::Unit(k2),
             Vec3::Unit(k) * reference.sign, axis.normal_A};
  } else {
    const Vec3 outward_A = reference.sign * pair.R.col(k);
    plane = {pair.t + outward_A * h[k], pair.R.col(k1), pair.R.col(k2), outward_A, -axis.normal_A};
  }

  ClipPolygon polygon(reference_is_a);
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t corner = incident.corner(i);
    const Vec3 p = box_corner(h_incident, corner);
    polygon.add_vertex(plane.to_plane(reference_is_a ? Vec3(pair.R * p + pair.t) : p), corner);
  }
  polygon.close();

  const double width =
      std::min({h[k1], h[k2], h_incident[(incident.k + 1) % 3], h_incident[(incident.k + 2) % 3]});
  const ContactTolerance tolerance = ContactTolerance::of(width, lie_face_to_face(face_a, face_b));
  // Sides in the order +u, +v, -u, -v, each from its lower to its upper corner as the loop runs for sign > 0.
  const std::uint32_t bit1 = 1u << k1, bit2 = 1u << k2,
                      base = static_cast<std::uint32_t>(reference.sign > 0.0) << k;
  const std::array<ClipSide, 4> sides = {{{1, 0, h[k1], base | bit1, base | bit1 | bit2},
                                          {0, 1, h[k2], base | bit1 | bit2, base | bit2},
                                          {-1, 0, h[k1], base | bit2, base},
                                          {0, -1, h[k2], base, base | bit1}}};
  for (const ClipSide& side : sides) polygon.cut(side, tolerance.inside);
  return polygon.make_manifold(plane, axis.normal_A, axis.separation <= 0.0, margin, tolerance.merge);
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

Manifold make_manifold(const BoxPair& pair, const Axis& axis, double margin, bool& face_to_face) {
  const BoxFace face_a = BoxFace::towards(axis.normal_A);
  const BoxFace face_b = BoxFace::towards(pair.R.transpose() * -axis.normal_A);
  face_to_face = lie_face_to_face(face_a, face_b);
  const bool flat = face_a.cosine > kFlat && face_b.cosine > kFlat;
  if (axis.kind == Axis::Kind::edges && !flat) return cross_edges(pair, axis, margin);
  return clip_faces(pair, axis, face_a, face_b, axis.kind == Axis::Kind::face_a || face_a.cosine > kFlat,
                    margin);
}

}  // namespace

Manifold collide_box_box(const Box& a, const Box& b, const Pose& X_AB, double margin, PairCache& cache) {
  const Mat3 R = rotation_matrix(X_AB.q);
  const BoxPair pair{a.half_extents, b.half_extents, X_AB.p, R, R.cwiseAbs()};
  const double tie = kTie * (pair.a.sum() + pair.b.sum());

  bool beyond = false;
  Axis best = find_face_axis(pair, margin, tie, beyond);
  if (!beyond) {
    const Axis edge = find_edge_axis(pair, margin, best.separation + tie, beyond);
    if (edge.separation > best.separation + tie) best = edge;
  }
  cache.axis_A = best.normal_A;
  cache.gap = best.separation;
  if (beyond) return {};
  bool face_to_face = false;
  const Manifold manifold = make_manifold(pair, best, margin, face_to_face);
  return contact_of_closest_points(manifold, best.separation, face_to_face, a, b, X_AB, margin, cache);
}

}  // namespace tumble
