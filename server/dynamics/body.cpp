// See body.h. The momentum is turned into the principal frame P, scaled there, and turned back.
#include "dynamics/body.h"

#include "math/rotation.h"

namespace tumble {
namespace {

Vec3 scale_in_principal_axes(const Vec3& factors, const Quat& q_BP, const Quat& q_WB, const Vec3& u_W) {
  if (factors.x() == factors.y() && factors.y() == factors.z()) return factors.x() * u_W;
  const Mat3 R_WP = rotation_matrix(q_WB * q_BP);
  return R_WP * factors.cwiseProduct(R_WP.transpose() * u_W);
}

}  // namespace

Vec3 angular_velocity(const MassProperties& mass, const Quat& q_WB, const Vec3& L_W) {
  return scale_in_principal_axes(mass.inv_I, mass.q_BP, q_WB, L_W);
}

Vec3 angular_momentum(const MassProperties& mass, const Quat& q_WB, const Vec3& w_W) {
  return scale_in_principal_axes(mass.I, mass.q_BP, q_WB, w_W);
}

void displace(const MassProperties& mass, const Vec3& shift, const Vec3& turn, Motion& body) {
  body.x += shift;
  if (turn.isZero(0.0)) return;
  body.q = normalized(exp_map(turn) * body.q);
  body.w = angular_velocity(mass, body.q, body.L);
}

}  // namespace tumble
