// The course's scheme as taught: v += dt a, x += dt v(t+dt), v_r += dt alpha with alpha = M^-T I^-1 M^T tau at the old
// orientation, q(t+dt) = q(t) q_r(dt). It leaves out the gyroscopic term w x I w: the world angular velocity stays while
// the body turns, so neither the angular momentum nor the energy of anything but a ball is kept.
#include "dynamics/integrator.h"

namespace tumble {

void integrate_course(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  body.v = path.v1;
  body.x += h * body.v;
  body.w = angular_velocity(mass, body.q, path.L1);
  const Vec3 w_B =
      body.q.conjugate() * body.w;  // q_r multiplies from the right: it is a rotation in body axes
  body.q = normalized(body.q * exp_map(h * w_B));
  body.L = angular_momentum(mass, body.q, body.w);
}

}  // namespace tumble
