// Primal-dual interior point method for the contact problem of one island: every contact a second-order cone, every
// rope a half line, every spring a quadratic term; the velocities of the movable bodies are the unknowns of the linear
// algebra. Some ten factorizations, whatever the mass ratio or the height of a stack.
#pragma once

#include "dynamics/best_impulses.h"
#include "dynamics/velocity_system.h"

namespace tumble {

/// Starts cold from the velocities v* of the problem, offers the impulses of every iterate to `best`, and ends once
/// these are below `tolerance` [m/s], no longer get better, or are not finite. Leaves any impulses in the problem.
/// Returns the number of factorizations, at most 40.
int run_interior_point(ContactProblem& problem, VelocitySystem& system, double tolerance, BestImpulses& best);

}  // namespace tumble
