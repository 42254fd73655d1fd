// One Gauss-Seidel visit of a contact or a row: what the sweeping solvers (pgs, soft_step, course_impulse) share. The
// angular parts r x d and I^-1 (r x d) of every direction are computed once a step into contiguous arrays.
// World frame; n from a to b, impulses + on b. Notation in here: u relative velocity, l impulse, k inverse mass.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynamics/contact_problem.h"

namespace tumble {

/// A vector in four lanes, the last 0: one register holds it, and element-wise operations give the same bits whatever
/// instruction set they are translated to.
struct Lanes {
  typedef double Four __attribute__((vector_size(32)));
  Four e = {0.0, 0.0, 0.0, 0.0};

  Lanes() = default;
  explicit Lanes(const Vec3& v) : e{v.x(), v.y(), v.z(), 0.0} {}
  Vec3 vec3() const { return {e[0], e[1], e[2]}; }
};

struct SweptBody {
  Lanes v, w;
};

/// A direction d at a point: u = d . (vB - vA) + jB . wB - jA . wA, and the answer of both bodies to an impulse.
struct SweptDirection {
  Lanes d, jA, jB;  ///< d; rA x d, rB x d
  Lanes gA, gB;     ///< I_A^-1 jA, I_B^-1 jB

  double velocity(const SweptBody& A, const SweptBody& B) const {
    const Lanes::Four u = d.e * (B.v.e - A.v.e) + (jB.e * B.w.e - jA.e * A.w.e);
    return (u[0] + u[1]) + (u[2] + u[3]);
  }
  void apply(double l, double inv_mass_A, double inv_mass_B, SweptBody& A, SweptBody& B) const {
    A.v.e -= (l * inv_mass_A) * d.e;
    A.w.e -= l * gA.e;
    B.v.e += (l * inv_mass_B) * d.e;
    B.w.e += l * gB.e;
  }
};

struct SweptContact {
  std::uint32_t a, b;
  double inv_mass_A, inv_mass_B;
  SweptDirection n, t1, t2;
  double mass_n, mass_t, friction;
  double bound;
  double l_n, l_1, l_2;
  double k_n, k_t;       ///< 1/mass_n, 1/mass_t [1/kg]
  double k_1n, k_2n;     ///< Velocity along t1, t2 for a unit normal impulse [1/kg].
  double i11, i12, i22;  ///< Inverse of K_tt [kg].
};

struct SweptRow {
  std::uint32_t a, b;
  double inv_mass_A, inv_mass_B;
  SweptDirection n;
  double mass, softness, bias, bound, lower, l;
  bool soft;
};

struct SweptTurning {
  std::uint32_t contact;     ///< Among the swept ones.
  Turning law;               ///< With the moment.
  SweptDirection n, t1, t2;  ///< Without a direction of its own: turns only.
};

struct Sweep {
  std::vector<SweptBody> bodies;
  std::vector<SweptContact> contacts;
  std::vector<SweptRow> rows;
  std::vector<SweptTurning> turnings;
};

/// Copies velocities and impulses in.
Sweep make_sweep(const ContactProblem& problem);

/// Brings the impulses back, not the velocities: the bodies get M^-1 J^T (change of the stored impulses), so rounding does
/// not collect over the sweeps and a residual computed then speaks of exactly what is returned.
void update_impulses(const Sweep& sweep, ContactProblem& problem);

/// Rigid conditions, rows then contacts in their order, or all of it backwards; returns the largest correction [m/s].
enum class SweepOrder { forward, backward };
double sweep_once(Sweep& sweep, SweepOrder order);

/// How the normal condition is softened: l <- max(0, l - m (scale u + push) - give l).
struct NormalRule {
  double push;  ///< [m/s]; rigid: -bound
  double scale = 1.0;
  double give = 0.0;
};

/// `impulse` along each direction at once.
inline void apply(const SweptContact& c, double l_n, double l_1, double l_2, SweptBody& A, SweptBody& B) {
  const Lanes::Four p = l_n * c.n.d.e + l_1 * c.t1.d.e + l_2 * c.t2.d.e;
  A.v.e -= c.inv_mass_A * p;
  A.w.e -= l_n * c.n.gA.e + l_1 * c.t1.gA.e + l_2 * c.t2.gA.e;
  B.v.e += c.inv_mass_B * p;
  B.w.e += l_n * c.n.gB.e + l_1 * c.t1.gB.e + l_2 * c.t2.gB.e;
}

/// Normal condition, then the friction disc of radius mu l_n. Inside the disc the 2 x 2 block is solved at once; else a
/// step of 1/lambda_max(K_tt) and the nearest point of the disc. Both have exactly the Coulomb solutions as fixed points:
/// the plain inverse followed by a projection would turn the friction away from the sliding direction where K_tt is not
/// isotropic. The bodies are read and written once: a sweep waits for its own last result, not for arithmetic.
/// Returns the square of the larger correction [m^2/s^2].
inline double visit_contact(SweptContact& c, const NormalRule& rule, SweptBody& A, SweptBody& B) {
  const double u_n = c.n.velocity(A, B);
  double u1 = c.t1.velocity(A, B), u2 = c.t2.velocity(A, B);
  const double l_n = std::max(0.0, c.l_n - c.mass_n * (rule.scale * u_n + rule.push) - rule.give * c.l_n);
  const double change_n = l_n - c.l_n;
  u1 += c.k_1n * change_n;
  u2 += c.k_2n * change_n;
  const double radius = c.friction * l_n;
  double l1 = c.l_1 - (c.i11 * u1 + c.i12 * u2), l2 = c.l_2 - (c.i12 * u1 + c.i22 * u2);
  if (l1 * l1 + l2 * l2 > radius * radius) {
    l1 = c.l_1 - c.mass_t * u1;
    l2 = c.l_2 - c.mass_t * u2;
    const double square = l1 * l1 + l2 * l2;
    if (square > radius * radius) {
      const double shrink = radius / std::sqrt(square);
      l1 *= shrink;
      l2 *= shrink;
    }
  }
  const double change1 = l1 - c.l_1, change2 = l2 - c.l_2;
  c.l_n = l_n;
  c.l_1 = l1;
  c.l_2 = l2;
  apply(c, change_n, change1, change2, A, B);
  const double r_n = c.k_n * change_n;
  return std::max(r_n * r_n, c.k_t * c.k_t * (change1 * change1 + change2 * change2));
}

/// Returns the square of the correction [m^2/s^2].
inline double visit_row(SweptRow& row, SweptBody& A, SweptBody& B) {
  const double u = row.n.velocity(A, B);
  const double change =
      row.soft ? -(row.l + row.softness * (u + row.bias)) * (row.mass / (row.mass + row.softness))
               : std::max(row.lower, row.l - row.mass * (u - row.bound)) - row.l;
  row.l += change;
  row.n.apply(change, row.inv_mass_A, row.inv_mass_B, A, B);
  const double r = change / row.mass;
  return r * r;
}

/// After its contact: the moment nearest to what would stop the turning, within what the normal impulse allows. Returns
/// the square of the correction [rad^2/s^2].
inline double visit_turning(SweptTurning& turning, double l_n, SweptBody& A, SweptBody& B) {
  Turning& law = turning.law;
  const Vec3 w(turning.n.velocity(A, B), turning.t1.velocity(A, B), turning.t2.velocity(A, B));
  const Vec3 mass(law.mass_n, law.mass_t, law.mass_t);
  const Vec3 l = nearest_moment(law, law.lambda - mass.cwiseProduct(w), l_n), change = l - law.lambda;
  law.lambda = l;
  turning.n.apply(change.x(), 0.0, 0.0, A, B);
  turning.t1.apply(change.y(), 0.0, 0.0, A, B);
  turning.t2.apply(change.z(), 0.0, 0.0, A, B);
  return change.cwiseQuotient(mass).squaredNorm();
}
/// Of all of them.
double visit_turnings(Sweep& sweep);

}  // namespace tumble
