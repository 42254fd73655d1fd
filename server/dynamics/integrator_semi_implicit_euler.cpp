// The course's drift with the world angular momentum as the state: L is kept exactly, and with it the gyroscopic term.
// Order 1 in the orientation.
#include "dynamics/integrator.h"

namespace tumble {

void integrate_semi_implicit_euler(const MassProperties& mass, const VelocityPath& path, double h,
                                   Motion& body) {
  body.x += h * path.v1;
  const Vec3 w = angular_velocity(mass, body.q, path.L1);
  set_end_of_step(mass, path, exp_map(h * w) * body.q, body);
}

}  // namespace tumble
