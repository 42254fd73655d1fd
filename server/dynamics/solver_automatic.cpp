// The exact solver where its cost is bounded, sub-steps where it would not be. The choice is made from counts alone,
// never from a clock, so it is the same on every machine. Both solvers store the impulses of whole steps, so an island
// may grow or shrink across the border and keep its warm start.
#include <algorithm>

#include "dynamics/solver.h"

namespace tumble {

SolverReport solve_automatic(ContactProblem& problem, const SolverSettings& settings) {
  const auto movable = std::count_if(problem.bodies.begin(), problem.bodies.end(),
                                     [](const SolverBody& body) { return body.inv_mass > 0.0; });
  return movable <= settings.exact_bodies ? solve_exact(problem, settings)
                                          : solve_soft_step(problem, settings);
}

}  // namespace tumble
