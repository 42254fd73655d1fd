// Classical Runge-Kutta of order 4 on the orientation alone, dq/dt = 1/2 q (0; w_P) with w_P = I^-1 q* L(t) q. L(t) is
// known exactly at every stage, so it is conserved; the energy is not. Frame P: principal axes.
#include "dynamics/integrator.h"

namespace tumble {
namespace {

/// dq_WP/dt. The stages are not unit quaternions; the division by |q|^2 makes q* L q a rotation of L all the same.
Quat derivative(const Vec3& inv_I, const Quat& q, const Vec3& L_W) {
  const Vec3 u(q.x(), q.y(), q.z());
  const Vec3 t = L_W.cross(u);  // q* L q / |q|^2 = L + 2 (w t + t x u) / |q|^2
  const Vec3 L_P = L_W + (2.0 / q.squaredNorm()) * (q.w() * t + t.cross(u));
  const Vec3 w = 0.5 * inv_I.cwiseProduct(L_P);
  return q * Quat(0.0, w.x(), w.y(), w.z());
}

Quat sum(const Quat& q, double s, const Quat& dq) {
  return Quat(Eigen::Vector4d(q.coeffs() + s * dq.coeffs()));
}

}  // namespace

void integrate_rk4(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  body.x += (0.5 * h) * (path.v0 + path.v1);
  const Quat q = body.q * mass.q_BP;
  const Vec3 L_middle = 0.5 * (path.L0 + path.L1);
  const Quat k1 = derivative(mass.inv_I, q, path.L0);
  const Quat k2 = derivative(mass.inv_I, sum(q, 0.5 * h, k1), L_middle);
  const Quat k3 = derivative(mass.inv_I, sum(q, 0.5 * h, k2), L_middle);
  const Quat k4 = derivative(mass.inv_I, sum(q, h, k3), path.L1);
  const Quat slope(Eigen::Vector4d(k1.coeffs() + 2.0 * (k2.coeffs() + k3.coeffs()) + k4.coeffs()));
  set_end_of_step(mass, path, sum(q, h / 6.0, slope) * mass.q_BP.conjugate(), body);
}

}  // namespace tumble
