// One Gauss-Seidel visit of a contact or a row: what the sweeping solvers (pgs, soft_step, course_impulse) share. The
// angular parts r x d and I^-1 (r x d) of every direction are computed once a step into contiguous arrays.
// World frame; n from a to b, impulses + on b. Notation in here: u relative velocity, l impulse, k inverse mass.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynamics/contact_problem.h"

namespace tumble {

struct Twist {
  Vec3 v, w;
};

/// A direction d at a point: u = d . (vB - vA) + jB . wB - jA . wA, and the answer of both bodies to an impulse.
struct SweptDirection {
  Vec3 d, jA, jB;  ///< d; rA x d, rB x d
  Vec3 gA, gB;     ///< I_A^-1 jA, I_B^-1 jB

  double velocity(const Twist& A, const Twist& B) const {
    return d.dot(B.v - A.v) + jB.dot(B.w) - jA.dot(A.w);
  }
  void apply(double l, double inv_mass_A, double inv_mass_B, Twist& A, Twist& B) const {
    A.v -= (l * inv_mass_A) * d;
    A.w -= l * gA;
    B.v += (l * inv_mass_B) * d;
    B.w += l * gB;
  }
};

struct SweptContact {
  std::uint32_t a, b;
  double inv_mass_A, inv_mass_B;
  SweptDirection n, t1, t2;
  double mass_n, mass_t, friction;
  double bound;
  double l_n, l_1, l_2;
  double i11, i12, i22;  ///< Inverse of K_tt [kg].
};

struct SweptRow {
  std::uint32_t a, b;
  double inv_mass_A, inv_mass_B;
  SweptDirection n;
  double mass, softness, bias, bound, lower, l;
  bool soft;
};

struct Sweep {
  std::vector<Twist> twists;
  std::vector<SweptContact> contacts;
  std::vector<SweptRow> rows;
};

/// Copies velocities and impulses in; and the impulses, not the velocities, back.
Sweep make_sweep(const ContactProblem& problem);
void store_impulses(const Sweep& sweep, ContactProblem& problem);

/// How the normal condition is softened: l <- max(0, l - m (scale u + push) - give l).
struct NormalRule {
  double push;         ///< [m/s]; rigid: -bound
  double scale = 1.0;
  double give = 0.0;
};

/// Returns the correction |change| / mass [m/s].
inline double visit_normal(SweptContact& c, const NormalRule& rule, Twist& A, Twist& B) {
  const double u = c.n.velocity(A, B);
  const double l = std::max(0.0, c.l_n - c.mass_n * (rule.scale * u + rule.push) - rule.give * c.l_n);
  const double change = l - c.l_n;
  c.l_n = l;
  c.n.apply(change, c.inv_mass_A, c.inv_mass_B, A, B);
  return std::abs(change) / c.mass_n;
}

/// The friction disc of radius mu l_n. Inside it the 2 x 2 block is solved at once; else a step of 1/lambda_max(K_tt)
/// and the nearest point of the disc. Both have exactly the Coulomb solutions as fixed points: the plain inverse followed
/// by a projection would turn the friction away from the sliding direction where K_tt is not isotropic.
inline double visit_friction(SweptContact& c, Twist& A, Twist& B) {
  const double u1 = c.t1.velocity(A, B), u2 = c.t2.velocity(A, B);
  const double radius = c.friction * c.l_n;
  double l1 = c.l_1 - (c.i11 * u1 + c.i12 * u2), l2 = c.l_2 - (c.i12 * u1 + c.i22 * u2);
  if (l1 * l1 + l2 * l2 > radius * radius) {
    l1 = c.l_1 - c.mass_t * u1;
    l2 = c.l_2 - c.mass_t * u2;
    const double length2 = l1 * l1 + l2 * l2;
    if (length2 > radius * radius) {
      const double shrink = radius / std::sqrt(length2);
      l1 *= shrink;
      l2 *= shrink;
    }
  }
  const double change1 = l1 - c.l_1, change2 = l2 - c.l_2;
  c.l_1 = l1;
  c.l_2 = l2;
  c.t1.apply(change1, c.inv_mass_A, c.inv_mass_B, A, B);
  c.t2.apply(change2, c.inv_mass_A, c.inv_mass_B, A, B);
  return std::sqrt(change1 * change1 + change2 * change2) / c.mass_t;
}

inline double visit_row(SweptRow& row, Twist& A, Twist& B) {
  const double u = row.n.velocity(A, B);
  const double change =
      row.soft ? -(row.l + row.softness * (u + row.bias)) * (row.mass / (row.mass + row.softness))
               : std::max(row.lower, row.l - row.mass * (u - row.bound)) - row.l;
  row.l += change;
  row.n.apply(change, row.inv_mass_A, row.inv_mass_B, A, B);
  return std::abs(change) / row.mass;
}

}  // namespace tumble
