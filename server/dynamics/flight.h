// A body between two events, under constant forces: its motion at any time from that at the start, exact to round-off,
// with no steps. Position by the closed parabola, orientation by FreeRotation, damping by its exponentials. World frame W,
// SI units; t counts from the start.
#pragma once

#include "collision/aabb.h"
#include "dynamics/free_rotation.h"

namespace tumble {

/// What acts on it: v' = acceleration - linear_damping v, L' = torque - angular_damping L.
struct FlightLoad {
  Vec3 acceleration = Vec3::Zero();                    ///< [m/s^2]
  Vec3 torque = Vec3::Zero();                          ///< In W [N m]; none where the rotation is damped.
  double linear_damping = 0.0, angular_damping = 0.0;  ///< [1/s], >= 0

  bool operator==(const FlightLoad&) const = default;
};

class Flight {
 public:
  /// At rest at the origin.
  Flight() = default;
  Flight(const MassProperties& mass, const Motion& start, const FlightLoad& load);
  Flight(const MassProperties& mass, const Motion& start, const Vec3& acceleration)
      : Flight(mass, start, FlightLoad{.acceleration = acceleration}) {}

  /// Without a torque. t >= 0; a little before the start is as good where nothing is damped.
  Motion at(double t) const;
  Vec3 position(double t) const;  ///< Of the centre of mass; a fraction of the cost of `at`.
  Vec3 velocity(double t) const;
  Vec3 angular_momentum(double t) const;

  /// Under a torque the orientation has no closed form: it takes Taylor steps from that at t0, all else takes none.
  bool turns_freely() const { return load_.torque.isZero(0.0); }
  Motion stepped(const MassProperties& mass, const Quat& q_at_t0, double t0, double t1) const;

  /// Holds the centre of mass from t0 to t1, up to rounding.
  Aabb path_bounds(double t0, double t1) const;

  const FlightLoad& load() const { return load_; }
  /// Fastest phase of the rotation [rad/s]; see FreeRotation.
  double phase_rate() const { return rotation_.phase_rate(); }

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  Vec3 x_ = Vec3::Zero(), v_ = Vec3::Zero(), L_ = Vec3::Zero();
  FlightLoad load_;
  FreeRotation rotation_;
};

}  // namespace tumble
