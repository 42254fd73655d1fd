// Restitution: contacts that strike in this step bounce before the smooth problem is solved. Contacts are taken one at
// a time, the hardest closing first, until none closes faster than the threshold: momentum passes through a cradle ball
// by ball, and since each single impulse is dissipative, kinetic energy never rises.
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

struct ImpactSettings {
  double threshold_speed;  ///< [m/s] closing speed below which a contact does not bounce.
  int max_impacts;         ///< Bound on impulses per contact of the island; what is left over is inelastic.
};

struct ImpactReport {
  std::uint64_t impacts = 0;
  bool capped = false;
};

/// In: start velocities v0, w0 of a prepared problem and v, w = v0, w0 plus one step of forces. Contacts with
/// restitution whose gap closes within the step and whose closing speed at the start of the step, beyond what one step
/// of forces produced (microcollision), exceeds the threshold bounce: v_s = -C_r v_c. Both v0 and v change by the
/// impulses.
ImpactReport resolve_impacts(ContactProblem& problem, const ImpactSettings& settings);

/// The course's impulse for one contact, frictionless: the unit impulse along n changes the closing velocity by
/// ds_A + ds_B; the fraction f of it that gives v_s = -C_r v_c.
struct UnitImpulse {
  Vec3 dv_A, dw_A, dv_B, dw_B;  ///< Velocity changes of both bodies for the unit impulse (-n on a, +n on b).
  double ds;                    ///< Change of u_n for the unit impulse [1/kg], > 0.
};
UnitImpulse unit_impulse(const SolverBody& A, const SolverBody& B, const Vec3& n, const Vec3& rA,
                         const Vec3& rB);
/// f [N s] with u_n + f ds = -restitution u_n.
double impulse_fraction(double u_n, double restitution, double ds);

}  // namespace tumble
