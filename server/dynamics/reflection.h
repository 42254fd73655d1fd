// Simultaneous impacts: the velocities after a blow that several contacts take part in. Generalized reflections (Smith,
// Kaufman, Vouga, Tamstorf, Grinspun, "Reflections on simultaneous impact", 2012): only contacts that approach act, all
// of them at once, and again, until none approaches. Each pass is Poisson's: compression to rest with Coulomb friction,
// then the restitution of every normal impulse, with friction solved anew. Joints hold and taut ropes pull in the same
// instant: a joint answers every impulse, a rope is a contact without friction and restitution that takes part in every
// pass.
#pragma once

#include "dynamics/contact_problem.h"

namespace tumble {

struct ReflectionSettings {
  int max_passes = 32;  ///< Then the contacts end it without restitution.
};

struct ReflectionReport {
  int passes = 0;
  bool capped = false;  ///< The passes ran out.
  int clamped = 0;      ///< Passes whose expansion was shortened because it would have gained energy.
};

/// In: a prepared problem whose contacts touch now; rows of joints, and of ropes that are taut; velocities v, w before the
/// blow. Out: those after it; lambda the impulses of the contacts. Separations, bounds and soft rows play no part. Momentum
/// is conserved to round-off, kinetic energy never rises.
ReflectionReport reflect(ContactProblem& problem, const ReflectionSettings& settings = {});

}  // namespace tumble
