// See flight.h.
#include "dynamics/flight.h"

#include <algorithm>
#include <cassert>

#include "dynamics/integrator.h"

namespace tumble {

Flight::Flight(const MassProperties& mass, const Motion& start, const FlightLoad& load)
    : x_(start.x), v_(start.v), L_(start.L), load_(load), rotation_(mass, start) {}

Vec3 Flight::position(double t) const {
  const double c = load_.linear_damping;
  if (c == 0.0) return x_ + t * (v_ + (0.5 * t) * load_.acceleration);
  return x_ + t * (mean_decay(c * t) * v_ + (t * mean_loss(c * t)) * load_.acceleration);
}

Vec3 Flight::velocity(double t) const {
  const double c = load_.linear_damping;
  if (c == 0.0) return v_ + t * load_.acceleration;
  return exp_decay(-c * t) * v_ + (t * mean_decay(c * t)) * load_.acceleration;
}

Vec3 Flight::angular_momentum(double t) const {
  const double c = load_.angular_damping;
  return c == 0.0 ? Vec3(L_ + t * load_.torque) : Vec3(exp_decay(-c * t) * L_);
}

Motion Flight::at(double t) const {
  assert(turns_freely());
  // Damping keeps the direction of L: the body turns as a free one does whose clock slows down with L.
  const double c = load_.angular_damping;
  const FreeRotation::State rotation = rotation_.at(c == 0.0 ? t : t * mean_decay(c * t));
  Motion motion{.x = position(t), .q = rotation.q_WB, .v = velocity(t), .L = L_, .w = rotation.w_WB};
  if (c > 0.0) {
    const double decay = exp_decay(-c * t);
    motion.L *= decay;
    motion.w *= decay;
  }
  return motion;
}

Motion Flight::stepped(const MassProperties& mass, const Quat& q_at_t0, double t0, double t1) const {
  assert(load_.angular_damping == 0.0);
  Motion motion;
  motion.q = q_at_t0;
  const VelocityPath path{.v0 = {}, .v1 = {}, .L0 = angular_momentum(t0), .L1 = angular_momentum(t1)};
  integrate_taylor8(mass, path, t1 - t0, motion);
  motion.x = position(t1);
  motion.v = velocity(t1);
  return motion;
}

Aabb Flight::path_bounds(double t0, double t1) const {
  const Vec3 x0 = position(t0), x1 = position(t1), v0 = velocity(t0), v1 = velocity(t1);
  Aabb bounds{x0.cwiseMin(x1), x0.cwiseMax(x1)};
  for (int i = 0; i < 3; ++i) {
    if (v0[i] * v1[i] >= 0.0) continue;
    // It turns back on the way, and never beyond where the tangents at both ends meet.
    const double meet = x0[i] + v0[i] * (x1[i] - x0[i] - v1[i] * (t1 - t0)) / (v0[i] - v1[i]);
    bounds.lower[i] = std::min(bounds.lower[i], meet);
    bounds.upper[i] = std::max(bounds.upper[i], meet);
  }
  return bounds;
}

}  // namespace tumble
