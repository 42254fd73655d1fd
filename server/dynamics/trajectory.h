// A body's way through one step, or through what is left of it after an impact: the motion at any time of it, and how
// fast points of the body can move and turn away from where a straight extrapolation sees them. World frame W, SI
// units; times count from the start of the step.
#pragma once

#include <optional>

#include "dynamics/flight.h"
#include "dynamics/integrator.h"

namespace tumble {

/// Bounds on a free body's rotation from now on: a point at the arm r [m] is accelerated by at most rate * r.
struct RotationBound {
  double speed = 0.0;  ///< Of w [rad/s].
  double rate = 0.0;   ///< Of |w'| + |w|^2 [1/s^2].
};

/// From the invariants of the polhode: how large each component of w can become while energy and momentum stay, with
/// `torque` [N m] acting for `time` [s].
RotationBound compute_rotation_bound(const MassProperties& mass, const Motion& motion, double torque,
                                     double time);

class Trajectory {
 public:
  /// Stays where it is.
  explicit Trajectory(const Motion& start = {}) {
    start_.x = start.x;
    start_.q = start.q;
  }

  /// Follows its given velocities from time `begin` on (kinematic).
  static Trajectory driven(const Motion& start, double begin);

  /// The pose follows `drift` from `begin` to `end`; `shift` [m] and `turn` [rad] come on top, evenly. The momenta run
  /// linearly from those of `start` to the drift's end: a body that closes a contact drifts with its end velocity.
  Trajectory(const MassProperties& mass, const Motion& start, double begin, double end,
             const VelocityPath& drift, IntegrateFunction integrate, const Vec3& shift = Vec3::Zero(),
             const Vec3& turn = Vec3::Zero());

  /// To a given end, with momenta that run linearly.
  Trajectory(const MassProperties& mass, const Motion& start, double begin, double end, const Motion& at_end,
             IntegrateFunction integrate);

  /// On an undamped flight that had lasted for `flown` [s] at time `begin`.
  Trajectory(const MassProperties& mass, const Motion& start, double begin, const Flight& flight,
             double flown);

  double begin() const { return begin_; }
  const Motion& start() const { return start_; }
  Motion at(double t) const;
  /// The same pose, with the velocities of the drift.
  Motion drift_at(double t) const;
  // Of the centre of mass, along the drift.
  Vec3 position(double t) const;
  Vec3 velocity(double t) const;
  Vec3 acceleration() const { return acceleration_; }
  /// True if no point ever moves.
  bool stays() const { return kind_ == Kind::stays; }
  bool flies() const { return kind_ == Kind::flies; }
  const RotationBound& rotation() const { return rotation_; }

 private:
  enum class Kind : std::uint8_t { stays, driven, flies, drifts };

  Motion start_;
  double begin_ = 0.0, end_ = 0.0;
  Kind kind_ = Kind::stays;
  Flight flight_;  // flies
  double flown_ = 0.0;
  const MassProperties* mass_ = nullptr;  // drifts
  IntegrateFunction integrate_ = nullptr;
  VelocityPath drift_, momenta_;
  std::optional<Motion> at_end_;
  Vec3 acceleration_ = Vec3::Zero(), torque_ = Vec3::Zero();
  Vec3 shift_ = Vec3::Zero(), turn_ = Vec3::Zero();
  RotationBound rotation_;
};

}  // namespace tumble
