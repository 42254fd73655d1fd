// See flight.h.
#include "dynamics/flight.h"

#include <algorithm>

namespace tumble {

Flight::Flight(const MassProperties& mass, const Motion& start, const Vec3& acceleration,
               double linear_damping, double angular_damping)
    : x_(start.x),
      v_(start.v),
      L_(start.L),
      acceleration_(acceleration),
      linear_damping_(linear_damping),
      angular_damping_(angular_damping),
      rotation_(mass, start) {}

Vec3 Flight::position(double t) const {
  if (linear_damping_ == 0.0) return x_ + t * (v_ + (0.5 * t) * acceleration_);
  const double ct = linear_damping_ * t;
  return x_ + t * (mean_decay(ct) * v_ + (t * mean_loss(ct)) * acceleration_);
}

Vec3 Flight::velocity(double t) const {
  if (linear_damping_ == 0.0) return v_ + t * acceleration_;
  const double ct = linear_damping_ * t;
  return exp_decay(-ct) * v_ + (t * mean_decay(ct)) * acceleration_;
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

Motion Flight::at(double t) const {
  // Damping keeps the direction of L: the body turns as a free one does whose clock slows down with L.
  const double decay = angular_damping_ == 0.0 ? 1.0 : exp_decay(-angular_damping_ * t);
  const double clock = angular_damping_ == 0.0 ? t : t * mean_decay(angular_damping_ * t);
  const FreeRotation::State rotation = rotation_.at(clock);
  return {
      .x = position(t), .q = rotation.q_WB, .v = velocity(t), .L = decay * L_, .w = decay * rotation.w_WB};
}

}  // namespace tumble
