// Newton's method from the warm start, alone: for comparison with the ladder of the exact solver, of which it is a rung.
#include "dynamics/ladder.h"

namespace tumble {

SolverReport solve_alm_newton(ContactProblem& problem, const SolverSettings& settings) {
  constexpr int kMaxSteps = 40;  // as many factorizations as the interior point has
  Ladder ladder(problem, settings);
  if (!ladder.solved()) ladder.newton(kMaxSteps);
  return ladder.finish();
}

}  // namespace tumble
