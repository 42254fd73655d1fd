// A rigid body: its handle, its kind, and its state of motion. World frame W, SI units.
#pragma once

#include <compare>
#include <cstdint>

#include "dynamics/mass_properties.h"
#include "math/rotation.h"

namespace tumble {

/// Handle that goes stale when its body is removed: a late command to a removed body is refused, not given to its
/// successor in the same slot.
struct BodyId {
  std::uint32_t index = 0, generation = 0;
  auto operator<=>(const BodyId&) const = default;
};

enum class BodyType : std::uint8_t {
  fixed,      ///< Never moves ("static" in SDF).
  dynamic,    ///< Moved by forces and contacts.
  kinematic,  ///< Moves with the velocities it is given, whatever pushes it.
};

/// The hot state, contiguous in the world's arrays. p_WB is the centre of mass.
struct Motion {
  Vec3 x = Vec3::Zero();      ///< p_WB [m]
  Quat q = Quat::Identity();  ///< q_WB
  Vec3 v = Vec3::Zero();      ///< v_WB of the centre of mass, in W [m/s]
  Vec3 L = Vec3::Zero();  ///< Angular momentum about the centre of mass, in W [kg m^2/s]; the angular state.
  Vec3 w = Vec3::Zero();  ///< w_WB in W [rad/s], derived: I_W^-1 L (dynamic bodies), given (kinematic ones).
};

/// w = I_W^-1 L at the orientation q (course: p_r = I v_r, inverted).
Vec3 angular_velocity(const MassProperties& mass, const Quat& q_WB, const Vec3& L_W);
/// L = I_W w.
Vec3 angular_momentum(const MassProperties& mass, const Quat& q_WB, const Vec3& w_W);
/// Shifts [m] and turns [rad, world axes] the body without a velocity: v and L stay.
void displace(const MassProperties& mass, const Vec3& shift, const Vec3& turn, Motion& body);
/// Velocity of the body's point at r [m] from the centre of mass (course: v = v_r x x' + v_l).
inline Vec3 point_velocity(const Motion& body, const Vec3& r_W) {
  return body.v + body.w.cross(r_W);
}

}  // namespace tumble
