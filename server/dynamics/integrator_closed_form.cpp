// The exact motion: where no torque acts, the closed form of the free rotation; under a torque, which has none, the Taylor
// series. A free body is not stepped by this at all (see flight.h); it serves bodies that something acts on.
#include "dynamics/free_rotation.h"
#include "dynamics/integrator.h"

namespace tumble {
namespace {

/// [rad] farther turns cost dmv8 more sub-steps than a closed form made anew.
constexpr double kShortTurn = 2.0;
/// Ratio of moments up to which dmv8's preprocessing keeps its digits: an error of 1e-7 at 1e5, of 1e-4 at 1e6.
constexpr double kAlike = 1e4;

}  // namespace

void integrate_closed_form(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  if (path.L0 != path.L1) return integrate_taylor8(mass, path, h, body);
  body.x += (0.5 * h) * (path.v0 + path.v1);
  body.L = path.L0;
  body.w = angular_velocity(mass, body.q, path.L0);
  const FreeRotation::State end = FreeRotation(mass, body).at(h);
  set_end_of_step(mass, path, end.q_WB, body);
}

void integrate_in_contact(const MassProperties& mass, const VelocityPath& path, double h, Motion& body) {
  if (path.L0 != path.L1) return integrate_taylor8(mass, path, h, body);
  const double turn = h * angular_velocity(mass, body.q, path.L0).norm();
  const bool by_dmv = turn < kShortTurn && mass.I.maxCoeff() < kAlike * mass.I.minCoeff();
  return by_dmv ? integrate_dmv8(mass, path, h, body) : integrate_closed_form(mass, path, h, body);
}

}  // namespace tumble
