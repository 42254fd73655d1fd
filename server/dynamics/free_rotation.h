// The rotation of a body on which no torque acts, in closed form: the orientation and angular velocity at any time from
// those at the start, exact to round-off, with no steps. Frames: P principal axes, B body, W world.
// Source: see tumbling.h for bodies with three different moments; all others turn steadily.
#pragma once

#include <array>

#include "dynamics/body.h"
#include "dynamics/tumbling.h"

namespace tumble {

class FreeRotation {
 public:
  struct State {
    Quat q_WB;
    Vec3 w_WB;  ///< In W [rad/s].
  };

  /// At rest at the identity.
  FreeRotation() = default;
  /// From q, L and w of `start` on. Where moments differ much, w knows the body's momentum about its thin axis better
  /// than L does; each component is taken from the better of the two.
  FreeRotation(const MassProperties& mass, const Motion& start);

  /// After t [s]; 2 sines and cosines, at most one exponential. The error grows like the rounding of the angle turned.
  /// The sign of the quaternion may jump between two times.
  State at(double t) const;

  /// Fastest phase [rad/s]: `at` keeps its digits while t times it is below 1e6 rad.
  double phase_rate() const;

 private:
  template <typename>
  friend struct Archived;  // its list of members, world/archive.cpp
  void classify(const MassProperties& mass, const Motion& start);
  void set_steady(const Vec3& rate_W, const Vec3& spin_B);
  void set_tumbling(const MassProperties& mass, const Vec3& w_P, const std::array<int, 3>& axes, double L);

  /// A turn at constant rate about an axis that stays.
  class Turn {
   public:
    Turn() = default;
    explicit Turn(const Vec3& rate);
    Quat after(double t) const;
    const Vec3& rate() const { return rate_; }
    double speed() const { return 2.0 * half_speed_; }

   private:
    template <typename>
    friend struct Archived;
    Vec3 rate_ = Vec3::Zero(), axis_ = Vec3::Zero();
    double half_speed_ = 0.0;
  };

  bool steady_ = true;
  Quat start_ =
      Quat::Identity();        ///< Steady: q_WB at the start. Tumbling: W from the frame whose z is along L.
  Turn about_L_, about_body_;  ///< Steady: in W about L, and in B about the body's axis of symmetry.
  Tumbling tumbling_;
  Quat q_SB_ = Quat::Identity();  ///< Tumbling: body axes to sorted axes S,
  Vec3 L_over_I_ = Vec3::Zero();  ///< and L/I of these [rad/s].
};

}  // namespace tumble
