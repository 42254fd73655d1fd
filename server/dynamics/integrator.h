// How a body moves through one step once its velocities at both ends are known. Rivals: one file each, one
// signature, chosen by name.
#pragma once

#include <optional>
#include <string_view>

#include "dynamics/body.h"

namespace tumble {

enum class Integrator {
  course,               ///< The slides' scheme: end velocities, no gyroscopic term, q <- q q_r(dt).
  semi_implicit_euler,  ///< The same drift with world angular momentum as the state.
  rk4,                  ///< Classical Runge-Kutta on the orientation, L(t) exact.
  taylor8,              ///< Taylor series of order 8 on (L_B, q), L(t) exact.
  dmv8,                 ///< Discrete Moser-Veselov, preprocessed to order 8; order 2 under torque.
  closed_form,          ///< Exact: free bodies in closed form, taylor8 under torque. The default.
};

/// v and L run linearly from their value at the start of the step to the one at its end (forces constant in W over
/// the step). Equal ends: uniform motion.
struct VelocityPath {
  Vec3 v0, v1;  ///< [m/s]
  Vec3 L0, L1;  ///< [kg m^2/s]
};

/// Moves x and q over h [s] and leaves v1 and L1 (and w derived from it) in `body`; body.q unit to round-off.
/// `course` alone keeps w instead of L over the turn, as taught: its L is not conserved.
void integrate_course(const MassProperties& mass, const VelocityPath& path, double h, Motion& body);
void integrate_semi_implicit_euler(const MassProperties& mass, const VelocityPath& path, double h,
                                   Motion& body);
void integrate_rk4(const MassProperties& mass, const VelocityPath& path, double h, Motion& body);
void integrate_taylor8(const MassProperties& mass, const VelocityPath& path, double h, Motion& body);
void integrate_dmv8(const MassProperties& mass, const VelocityPath& path, double h, Motion& body);
void integrate_closed_form(const MassProperties& mass, const VelocityPath& path, double h, Motion& body);
/// What closed_form does with a body in contact, whose momentum changes at every step: dmv8 while it turns with constant
/// momentum, which keeps energy and momentum to rounding at a third of the cost of a closed form made anew; the closed form
/// for far turns and for moments that differ by more than 1e4.
void integrate_in_contact(const MassProperties& mass, const VelocityPath& path, double h, Motion& body);

/// Moves a body that follows its given velocities, whatever acts on it (kinematic): x += h v, q <- exp(h w) q.
void move_kinematic(Motion& body, double h);

/// What the integrators share: leaves v1, L1, the orientation (normalised here) and the w that belongs to them.
void set_end_of_step(const MassProperties& mass, const VelocityPath& path, const Quat& q_WB, Motion& body);

using IntegrateFunction = void (*)(const MassProperties&, const VelocityPath&, double, Motion&);
IntegrateFunction integrate_function(Integrator integrator);

const char* integrator_name(Integrator integrator);
std::optional<Integrator> integrator_from_name(std::string_view name);

}  // namespace tumble
