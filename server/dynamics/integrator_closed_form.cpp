// The exact motion: where no torque acts, the closed form of the free rotation; under a torque, which has none, the Taylor
// series. A free body is not stepped by this at all (see flight.h); it serves bodies that something acts on.
#include "dynamics/free_rotation.h"
#include "dynamics/integrator.h"

namespace tumble {

void integrate_closed_form(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  if (path.L0 != path.L1) return integrate_taylor8(mass, path, h, body);
  body.x += (0.5 * h) * (path.v0 + path.v1);
  body.L = path.L0;
  body.w = angular_velocity(mass, body.q, path.L0);
  const FreeRotation::State end = FreeRotation(mass, body).at(h);
  set_end_of_step(mass, path, end.q_WB, body);
}

void integrate_in_contact(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  return path.L0 == path.L1 ? integrate_dmv8(mass, path, h, body) : integrate_taylor8(mass, path, h, body);
}

}  // namespace tumble
