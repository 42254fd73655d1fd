// Discrete Moser-Veselov steps on preprocessed moments, order 8 (Hairer and Vilmart 2006): a Cayley step c with
//   J c + c x (J c) = (1 + |c|^2) h/2 L,   q <- q (1; c),
// keeps the momentum and the energy of the body to rounding; moments J that differ from I by series in h make it follow
// the true motion to order 8. A torque acts half before and half after the turn (order 2). Frame P: principal axes.
#include <algorithm>
#include <cmath>

#include "dynamics/integrator.h"

namespace tumble {
namespace {

/// Angle per sub-step [rad]: the largest at which the step is worth its order; from 1.5 on it has no solution.
constexpr double kLargestTurn = 0.3;
/// At most this many sub-steps a step (18000 rad/s at 240 Hz); a faster body is turned about its momentary axis.
constexpr double kMostTurns = 256.0;

/// 1/J of a body with moments I for a turn of h with momentum L, l = h L. In D = I_1 I_2 I_3, P_n = sum I_i^n,
/// p_n = sum I_i^-n, M_ab = sum over i != j of I_j^a / I_i^b, N = |l|^2 / 2 and H = l . I^-1 l / 2.
Vec3 inverse_preprocessed_moments(const Vec3& I, const Vec3& l) {
  const Vec3 u = I.cwiseInverse();
  const Vec3 I2 = I.cwiseProduct(I), I3 = I2.cwiseProduct(I), u2 = u.cwiseProduct(u), u3 = u2.cwiseProduct(u);
  const double D = I.x() * I.y() * I.z(), D2 = D * D, D3 = D2 * D;
  const double P1 = I.sum(), P2 = I2.sum(), P3 = I3.sum(), p1 = u.sum(), p2 = u2.sum(), p3 = u3.sum();
  const double M11 = P1 * p1 - 3.0, M21 = P2 * p1 - P1, M12 = P1 * p2 - p1;
  const double N = 0.5 * l.squaredNorm(), H = 0.5 * l.dot(u.cwiseProduct(l));
  const double NN = N * N, NH = N * H, HH = H * H;

  const double s4 = P1 * N / (6.0 * D) - p1 * H / 3.0;
  const double d4 = -N / (3.0 * D) + P1 * H / (6.0 * D);
  const double s6 =
      (P2 / D - p1) * NN / (30.0 * D) + (1.0 - M11) * NH / (30.0 * D) + (3.0 * P1 / D + 2.0 * p2) * HH / 60.0;
  const double d6 =
      -P1 * NN / (60.0 * D2) + (p1 / (10.0 * D) - P2 / (60.0 * D2)) * NH - (9.0 + M11) * HH / (60.0 * D);
  const double s8 = (4.0 * D + 17.0 * P3 - 15.0 * D * M11) * NN * N / (2520.0 * D3) +
                    (9.0 * P1 + 10.0 * D * p2 - 6.0 * M21) * NN * H / (420.0 * D2) +
                    ((6.0 * M12 - 100.0 * p1) * D + 53.0 * P2) * NH * H / (2520.0 * D2) +
                    (15.0 - D * p3 - 2.0 * M11) * HH * H / (630.0 * D);
  const double d8 = (34.0 * D * p1 - 19.0 * P2) * NN * N / (2520.0 * D3) +
                    (P3 + 2.0 * D * M11 - 85.0 * D) * NN * H / (1260.0 * D3) +
                    (47.0 * P1 + 13.0 * M21 - 38.0 * D * p2) * NH * H / (2520.0 * D2) +
                    (9.0 * D * p1 + D * M12 - 11.0 * P2) * HH * H / (1260.0 * D2);
  return (1.0 + (s4 + (s6 + s8))) * u + Vec3::Constant(d4 + (d6 + d8));
}

/// The Cayley vector c, by Gauss-Seidel sweeps from the small-step solution.
Vec3 solve_turn(const Vec3& inv_J, const Vec3& half_l) {
  const Vec3 J = inv_J.cwiseInverse();
  const Vec3 a = inv_J.cwiseProduct(half_l);
  const Vec3 phi(inv_J.x() * (J.y() - J.z()), inv_J.y() * (J.z() - J.x()), inv_J.z() * (J.x() - J.y()));
  Vec3 c;
  c.x() = a.x() + phi.x() * a.y() * a.z();
  c.y() = a.y() + phi.y() * c.x() * a.z();
  c.z() = a.z() + phi.z() * c.x() * c.y();
  for (int sweep = 0; sweep < 50; ++sweep) {  // 7 at 0.1 rad, 12 at 0.3 rad
    const Vec3 before = c;
    const double alpha = 1.0 + c.squaredNorm();
    c.x() = alpha * a.x() + phi.x() * c.y() * c.z();
    c.y() = alpha * a.y() + phi.y() * c.x() * c.z();
    c.z() = alpha * a.z() + phi.z() * c.x() * c.y();
    if ((c - before).lpNorm<1>() < 4e-16 * c.lpNorm<1>()) break;
  }
  return c;
}

/// q_WP after h [s] with constant momentum.
Quat turned(const MassProperties& mass, const Vec3& L_W, double h, Quat q) {
  const double largest = mass.I.maxCoeff();
  const Vec3 I = mass.I / largest;  // without a unit, so that no power of it leaves the range of doubles
  Vec3 l = q.conjugate() * Vec3((h / largest) * L_W);
  const double angle = l.cwiseQuotient(I).norm();
  if (!(angle < kMostTurns)) return q * exp_map(l.cwiseQuotient(I));
  const double parts = std::max(std::ceil(angle / kLargestTurn), 1.0);
  l /= parts;
  const Vec3 inv_J = inverse_preprocessed_moments(I, l);
  for (double part = 0.0; part < parts; part += 1.0) {
    if (part > 0.0) l = q.conjugate() * Vec3((h / (parts * largest)) * L_W);
    const Vec3 c = solve_turn(inv_J, 0.5 * l);
    q = normalized(q * Quat(1.0, c.x(), c.y(), c.z()));
  }
  return q;
}

}  // namespace

void integrate_dmv8(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  body.x += (0.5 * h) * (path.v0 + path.v1);
  const Vec3 L = 0.5 * (path.L0 + path.L1);
  const bool ball = mass.I.x() == mass.I.y() && mass.I.y() == mass.I.z();
  const Quat q_WB = ball ? exp_map((h * mass.inv_I.x()) * L) * body.q
                         : turned(mass, L, h, body.q * mass.q_BP) * mass.q_BP.conjugate();
  set_end_of_step(mass, path, q_WB, body);
}

}  // namespace tumble
