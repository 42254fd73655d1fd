// Newton's method on Coulomb's law itself, each step of it regularized as a step of the method of multipliers
// (augmented Lagrangian): quadratic near the solution, where the interior point slows down, and a step or two from a
// warm start. Not robust from afar.
#pragma once

#include "dynamics/best_impulses.h"
#include "dynamics/velocity_system.h"

namespace tumble {

/// Starts from the best impulses so far, offers every iterate to `best`, and ends once one is below `tolerance` [m/s],
/// they no longer get better, or after `max_iterations`. Leaves any impulses in the problem. Returns the
/// number of factorizations.
int run_alm_newton(ContactProblem& problem, VelocitySystem& system, double tolerance, int max_iterations,
                   BestImpulses& best);

}  // namespace tumble
