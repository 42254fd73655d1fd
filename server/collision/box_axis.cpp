// See box_axis.h. Faces first, then the crossings of edges: all nine without their roots, and of those the few that may
// separate more.
#include "collision/box_axis.h"

#include <utility>

#include "collision/segment.h"
#include "math/rotation.h"

namespace tumble {
namespace {

/// sin^2 of the angle between two edges below which their axis is evaluated with all six extents, since its unit axis is
/// rounded. Below kParallel it is no direction any more.
constexpr double kNearlyParallel = 1e-6;
/// Axes whose separations differ by less than this share of the sizes are equal but for rounding: the first one stays.
constexpr double kAxisTie = 1e-14;

BoxAxis find_face_axis(const BoxPair& pair, double tie) {
  const Vec3 &a = pair.a, &b = pair.b, &t = pair.t;
  const auto column_abs = [&](int j) { return absolute(four(pair.R(0, j), pair.R(1, j), pair.R(2, j))); };
  const Four a_axes =
      absolute(four(t)) - (four(a) + b.x() * column_abs(0) + b.y() * column_abs(1) + b.z() * column_abs(2));
  const Four b_axes =
      absolute(four(pair.t_B)) - (four(b) + a.x() * absolute(pair.rows[0]) + a.y() * absolute(pair.rows[1]) +
                                  a.z() * absolute(pair.rows[2]));
  int i = 0, j = 0;
  for (int k = 1; k < 3; ++k) {
    if (a_axes[k] > a_axes[i] + tie) i = k;
    if (b_axes[k] > b_axes[j] + tie) j = k;
  }
  if (b_axes[j] > a_axes[i] + tie) {
    return {b_axes[j], std::copysign(1.0, pair.t_B[j]), BoxAxis::Kind::face_b, 0, j};
  }
  return {a_axes[i], std::copysign(1.0, pair.t[i]), BoxAxis::Kind::face_a, i, 0};
}

/// Separation along n = scale e_i x r_j, unit, with |n . e_i| and |n . r_j| (zero but for rounding) counted if `honest`.
template <int i, int j>
BoxAxis evaluate_edge_axis(const BoxPair& pair, double scale, bool honest) {
  const Vec3 n = scale * Vec3::Unit(i).cross(pair.R.col(j));
  const double centre = n.dot(pair.t);
  double extents = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (k != i || honest) extents += pair.a[k] * std::abs(n[k]);
    if (k != j || honest) extents += pair.b[k] * std::abs(n.dot(pair.R.col(k)));
  }
  return {std::abs(centre) - extents, std::copysign(scale, centre), BoxAxis::Kind::edges, i, j};
}

/// Whether scaled / sqrt(length2) > floor, without the root; may say yes within rounding.
bool may_exceed(double scaled, double length2, double floor) {
  const double square = scaled * scaled, floor2 = floor * floor * length2;
  return scaled < 0.0 ? floor < 0.0 && square <= floor2 * (1.0 + 1e-12)
                      : floor <= 0.0 || square >= floor2 * (1.0 - 1e-12);
}

/// Of the crossings e_i x r_j, lane j of [i]: the separation along it times its length; whether it separates more than
/// `at_least` but for rounding, or is too short to say.
struct Crossings {
  Crossings(const BoxPair& pair, double at_least) {
    const std::array<Four, 3>& R = pair.rows;
    const std::array<Four, 3> R_abs = {absolute(R[0]), absolute(R[1]), absolute(R[2])};
    const Four b = four(pair.b);
    const Four b1 = rotated_three<1>(b), b2 = rotated_three<2>(b);
    const double limit = at_least - kAxisTie * pair.size;
    const Four limit2 = four(limit * std::abs(limit));
    const auto evaluate = [&]<std::size_t i>(std::integral_constant<std::size_t, i>) {
      // e_i x r_j = (0, -R(i2, j), R(i1, j)) in the cyclic order of i; its products with r_j1, r_j2 are entries of R.
      constexpr std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      const Four centre = four(pair.t[i2]) * R[i1] - four(pair.t[i1]) * R[i2];
      const Four extents = four(pair.a[i1]) * R_abs[i2] + four(pair.a[i2]) * R_abs[i1] +
                           b1 * rotated_three<2>(R_abs[i]) + b2 * rotated_three<1>(R_abs[i]);
      const Four length2 = R[i1] * R[i1] + R[i2] * R[i2];
      scaled[i] = absolute(centre) - extents;
      may_win[i] = (scaled[i] * absolute(scaled[i]) >= limit2 * length2) | (length2 < four(kNearlyParallel));
    };
    evaluate(std::integral_constant<std::size_t, 0>());
    evaluate(std::integral_constant<std::size_t, 1>());
    evaluate(std::integral_constant<std::size_t, 2>());
  }

  std::array<Four, 3> scaled;
  std::array<FourFlags, 3> may_win;
};

/// Replaces `best` by the crossing of A's axis i with B's axis j if that separates more, and more than `at_least`.
template <int i, int j>
void try_edge_axis(const BoxPair& pair, double scaled, double at_least, BoxAxis& best) {
  constexpr int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
  const double floor = std::max(best.separation, at_least);
  // The cross product is no longer than 1: divided by that, an overlap only grows.
  if (scaled < 0.0 && scaled < floor) return;
  const double length2 = pair.R(i1, j) * pair.R(i1, j) + pair.R(i2, j) * pair.R(i2, j);
  const bool honest = length2 < kNearlyParallel;
  if (!honest && !may_exceed(scaled, length2, floor)) return;
  if (length2 < kParallel) return;
  const BoxAxis axis = evaluate_edge_axis<i, j>(pair, 1.0 / std::sqrt(length2), honest);
  if (axis.separation > best.separation) best = axis;
}

/// The best of the nine crossings, or the first beyond the margin.
BoxAxis find_edge_axis(const BoxPair& pair, double margin, double at_least) {
  const Crossings crossings(pair, at_least);
  BoxAxis best;
  const auto try_all = [&]<std::size_t... k>(std::index_sequence<k...>) {
    (void)(... || (crossings.may_win[k / 3][k % 3] != 0 &&
                   (try_edge_axis<k / 3, k % 3>(pair, crossings.scaled[k / 3][k % 3], at_least, best),
                    best.separation > margin)));
  };
  try_all(std::make_index_sequence<9>{});
  return best;
}

}  // namespace

BoxPair::BoxPair(const Box& box_a, const Box& box_b, const Pose& X_AB)
    : a(box_a.half_extents),
      b(box_b.half_extents),
      t(X_AB.p),
      R(rotation_matrix(X_AB.q)),
      rows{four(R(0, 0), R(0, 1), R(0, 2)), four(R(1, 0), R(1, 1), R(1, 2)), four(R(2, 0), R(2, 1), R(2, 2))},
      t_B(R.transpose() * t),
      size(a.sum() + b.sum()) {}

BoxAxis find_axis(const BoxPair& pair, double margin) {
  const double tie = kAxisTie * pair.size;
  const BoxAxis face = find_face_axis(pair, tie);
  if (face.separation > margin) return face;
  const BoxAxis edges = find_edge_axis(pair, margin, face.separation + tie);
  return edges.separation > face.separation + tie ? edges : face;
}

}  // namespace tumble
