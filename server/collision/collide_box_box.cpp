// Box against box in A's frame: fifteen axes, then a manifold. See collide_box_box.h.
#include "collision/collide_box_box.h"

#include <limits>

#include "collision/axis_preference.h"
#include "collision/clip.h"
#include "collision/segment_contact.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// sin^2 of the angle between two edges below which their axis is no direction any more. What lies between that and
/// kNearlyParallel is evaluated with all six extents, since its unit axis is rounded.
constexpr double kParallel = 1e-24, kNearlyParallel = 1e-6;

/// a, b: half extents; R, t: pose of B in A; columns of R are B's axes.
struct BoxPair {
  Vec3 a, b, t;
  Mat3 R, R_abs;
};

struct Axis {
  double separation = -std::numeric_limits<double>::infinity();
  Vec3 normal_A = Vec3::UnitZ();  // unit, from A to B
  int i = 0, j = 0;               // faces: i = 0..2 of A, 3..5 of B; edges: axis i of A, j of B
  double sin2 = 1.0;              // of the angle between the edges
};

/// The best face axis, or, if `beyond` says so, the first one that separates by more than the margin.
Axis find_face_axis(const BoxPair& pair, double margin, double preference, bool& beyond) {
  Axis best;
  for (int i = 0; i < 6; ++i) {
    const int k = i % 3;
    const bool of_a = i < 3;
    const double centre = of_a ? pair.t[k] : pair.R.col(k).dot(pair.t);
    const double extents =
        of_a ? pair.a[k] + pair.R_abs.row(k).dot(pair.b) : pair.b[k] + pair.R_abs.col(k).dot(pair.a);
    const double separation = std::abs(centre) - extents;
    beyond = separation > margin;
    if (!beyond && separation <= best.separation + preference) continue;
    const double sign = std::copysign(1.0, centre);
    best = {separation, of_a ? Vec3(sign * Vec3::Unit(k)) : Vec3(sign * pair.R.col(k)), i};
    if (beyond) return best;
  }
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
  return {std::abs(centre) - extents, std::copysign(1.0, centre) * n, i, j, length * length};
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

/// Corner k of the face of a box (half extents h) across axis `axis`, on side `sign`; counter-clockwise from outside.
Vec3 face_corner(const Vec3& h, int axis, double sign, int k) {
  const double first = k == 0 || k == 3 ? -1.0 : 1.0, second = k < 2 ? -1.0 : 1.0;
  Vec3 corner;
  corner[axis] = sign * h[axis];
  corner[(axis + 1) % 3] = sign * first * h[(axis + 1) % 3];
  corner[(axis + 2) % 3] = second * h[(axis + 2) % 3];
  return corner;
}

Manifold clip_faces(const BoxPair& pair, const Axis& axis, double margin) {
  const bool of_a = axis.i < 3;
  const int k = axis.i % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  const Vec3& h = of_a ? pair.a : pair.b;
  const Vec3& h_other = of_a ? pair.b : pair.a;
  const Vec3 outward_A = of_a ? axis.normal_A : Vec3(-axis.normal_A);
  FacePlane plane;
  if (of_a) {
    plane = {outward_A * h[k], Vec3::Unit(k1), Vec3::Unit(k2), outward_A};
  } else {
    plane = {pair.t + outward_A * h[k], pair.R.col(k1), pair.R.col(k2), outward_A};
  }

  const Vec3 outward_other = of_a ? Vec3(pair.R.transpose() * outward_A) : outward_A;
  int m = 0;
  outward_other.cwiseAbs().maxCoeff(&m);
  const double side = -std::copysign(1.0, outward_other[m]);
  ClipPolygon polygon;
  for (int corner = 0; corner < 4; ++corner) {
    const Vec3 p = face_corner(h_other, m, side, corner);
    polygon.add_vertex(plane.to_plane(of_a ? Vec3(pair.R * p + pair.t) : p));
  }
  polygon.close();

  const double width = std::min({h[k1], h[k2], h_other[(m + 1) % 3], h_other[(m + 2) % 3]});
  const ContactTolerance tolerance = ContactTolerance::of(width);
  const std::array<ClipSide, 4> sides = {{{1, 0, h[k1]}, {0, 1, h[k2]}, {-1, 0, h[k1]}, {0, -1, h[k2]}}};
  for (std::uint32_t s = 0; s < 4; ++s) polygon.cut(sides[s], s, tolerance.inside);
  const std::uint32_t faces = static_cast<std::uint32_t>(axis.i * 8 + m * 2 + (side > 0.0));
  return polygon.make_manifold(plane, axis.normal_A, margin, tolerance.merge, faces);
}

/// Of a box with axes as columns of R: the edge along axis `i` that reaches furthest along n.
Segment edge_along(const Vec3& h, const Mat3& R, const Vec3& centre, int i, const Vec3& n,
                   std::uint32_t& id) {
  Segment edge{centre, h[i] * R.col(i)};
  id = static_cast<std::uint32_t>(i);
  for (const int k : {(i + 1) % 3, (i + 2) % 3}) {
    const bool positive = n.dot(R.col(k)) >= 0.0;
    edge.centre += (positive ? h[k] : -h[k]) * R.col(k);
    id = 2 * id + (positive ? 1u : 0u);
  }
  return edge;
}

Manifold cross_edges(const BoxPair& pair, const Axis& axis, double margin) {
  std::uint32_t id_a = 0, id_b = 0;
  const Segment a = edge_along(pair.a, Mat3::Identity(), Vec3::Zero(), axis.i, axis.normal_A, id_a);
  const Segment b = edge_along(pair.b, pair.R, pair.t, axis.j, -axis.normal_A, id_b);
  const ContactTolerance tolerance = ContactTolerance::of(std::min(pair.a.minCoeff(), pair.b.minCoeff()));
  return make_segment_manifold({a, 0.0}, {b, 0.0}, axis.normal_A, margin, tolerance.merge,
                               mix_features(id_a, id_b, 1));
}

}  // namespace

Manifold collide_box_box(const Box& a, const Box& b, const Pose& X_AB, double margin, PairCache& cache) {
  const Mat3 R = rotation_matrix(X_AB.q);
  const BoxPair pair{a.half_extents, b.half_extents, X_AB.p, R, R.cwiseAbs()};
  const AxisPreference preference = AxisPreference::of(std::min(pair.a.norm(), pair.b.norm()));

  bool beyond = false, crossing = false;
  Axis best = find_face_axis(pair, margin, preference.face, beyond);
  if (!beyond) {
    const Axis edge = find_edge_axis(pair, margin, best.separation, beyond);
    crossing = beyond || preference.takes_edge(best.separation, best.normal_A, edge.separation, edge.normal_A,
                                               edge.sin2);
    if (crossing) best = edge;
  }
  cache.axis_A = best.normal_A;
  cache.gap = best.separation;
  if (beyond) return {};
  return crossing ? cross_edges(pair, best, margin) : clip_faces(pair, best, margin);
}

}  // namespace tumble
