// The last digits of rest: a solver leaves an island that stands a velocity below its tolerance, which rest drops; here
// the impulses take over the momentum that goes with it, so that they hold the island to rounding and their sums are
// right to the last digits (forces that are read, warm starts of the steps after rest).
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

/// In: a solved problem whose bodies are about to rest. Out: their velocities zero, and the impulses that hold them so
/// against the forces of a step, v* - v0 + M^-1 J^T lambda = 0: the least change, in which only what carries load takes part, in proportion to how far it is
/// from its bound. False, with the impulses as they were: with these the residual would not be below `tolerance` [m/s].
bool balance_impulses(ContactProblem& problem, double tolerance);

}  // namespace tumble
