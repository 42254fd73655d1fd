// The method of multipliers on the friction cones, each of its problems solved to the end by Newton's method: for contacts
// that share a load with others, or hardly carry any (heaps), where a single Newton step a multiplier does not settle who
// carries what. Needs a near start, which the interior point gives, and ends where that and alm_newton stall.
#pragma once

#include "dynamics/best_impulses.h"
#include "dynamics/velocity_system.h"

namespace tumble {

/// Goes on from the best impulses so far, for at most `max_iterations`, until `tolerance` [m/s]. Turnings stay as they are.
/// Returns the number of factorizations, as does the next.
int run_cone_newton(ContactProblem& problem, VelocitySystem& system, double tolerance, int max_iterations,
                    BestImpulses& best);

/// For problems without a solution (a press that asks for the impossible): from no impulses, those of contacts that give way
/// a little, which violates the conditions least. Replaces what `best` knew.
int find_compromise(ContactProblem& problem, VelocitySystem& system, BestImpulses& best);

}  // namespace tumble
