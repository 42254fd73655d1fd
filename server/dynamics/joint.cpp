// See joint.h.
#include "dynamics/joint.h"

#include <algorithm>

#include "math/rotation.h"

namespace tumble {
Joint make_ball_joint(const Vec3& pA, const Vec3& pB) {
  Joint joint;
  for (int k = 0; k < 3; ++k) joint.held[joint.rows++] = {pA, pB, Vec3::Unit(k)};
  return joint;
}

Joint make_fixed_joint(const Vec3& pA, const Vec3& pB, const Quat& q_AB, double arm) {
  Joint joint = make_ball_joint(pA, pB);
  for (int k = 0; k < 3; ++k) {
    const Vec3 beside = arm * Vec3::Unit(k);
    joint.held[joint.rows++] = {pA + beside, pB + q_AB.conjugate() * beside, Vec3::Unit((k + 1) % 3)};
  }
  return joint;
}

ScalarRow make_joint_row(const HeldPoint& held, std::uint32_t a, std::uint32_t b, const SolverBody& A,
                         const SolverBody& B) {
  ScalarRow row;
  row.a = a;
  row.b = b;
  row.lower = -kInfinity;
  row.n = A.q * held.n_A;
  row.rA = A.q * held.pA;
  row.rB = B.q * held.pB;
  return row;
}

ScalarRow make_joint_row(const HeldPoint& held, std::uint32_t a, std::uint32_t b, const SolverBody& A,
                         const SolverBody& B, double h, const BoundSettings& settings) {
  ScalarRow row = make_joint_row(held, a, b, A, B);
  const Vec3 rA = row.rA, rB = row.rB;
  // Mean of both ends, not the arm in the middle: what turns steadily then has the same speed at the end.
  row.rA = 0.5 * (rA + exp_map(0.5 * h * (A.w0 + A.w)) * rA);
  row.rB = 0.5 * (rB + exp_map(0.5 * h * (B.w0 + B.w)) * rB);
  row.gap = row.n.dot(B.x + rB - A.x - rA);
  if (settings.push_fraction > 0.0)
    row.closing = -std::clamp(row.gap / h, -settings.push_speed, settings.push_speed);
  // What the arms turn in half a step is taken back in the other half; a speed at the start that parts the points is not.
  const double turning = row.n.dot(relative_start_velocity(A, B, row.rA, row.rB)) -
                         row.n.dot(relative_start_velocity(A, B, rA, rB));
  row.bound = row.closing - turning;
  return row;
}

}  // namespace tumble
