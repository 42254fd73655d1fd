// A body between two events, under a constant acceleration: its motion at any time from that at the start, exact to
// round-off, with no steps. Position by the closed parabola, orientation by FreeRotation, damping by its exponentials.
// World frame W, SI units; t counts from the start.
#pragma once

#include "collision/aabb.h"
#include "dynamics/free_rotation.h"

namespace tumble {

class Flight {
 public:
  /// At rest at the origin.
  Flight() = default;
  /// v' = acceleration - linear_damping v, L' = -angular_damping L; dampings >= 0 [1/s].
  Flight(const MassProperties& mass, const Motion& start, const Vec3& acceleration,
         double linear_damping = 0.0, double angular_damping = 0.0);

  /// t >= 0; a little before the start is as good where nothing is damped.
  Motion at(double t) const;
  Vec3 position(double t) const;  ///< Of the centre of mass; a fraction of the cost of `at`.
  Vec3 velocity(double t) const;

  /// Holds the centre of mass from t0 to t1, up to rounding.
  Aabb path_bounds(double t0, double t1) const;

  const Vec3& acceleration() const { return acceleration_; }
  /// Fastest phase of the rotation [rad/s]; see FreeRotation.
  double phase_rate() const { return rotation_.phase_rate(); }

 private:
  Vec3 x_ = Vec3::Zero(), v_ = Vec3::Zero(), L_ = Vec3::Zero();
  Vec3 acceleration_ = Vec3::Zero();
  double linear_damping_ = 0.0, angular_damping_ = 0.0;
  FreeRotation rotation_;
};

}  // namespace tumble
