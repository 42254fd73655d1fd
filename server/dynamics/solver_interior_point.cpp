// The interior point, alone: for comparison with the ladder of the exact solver, of which it is a rung.
#include "dynamics/ladder.h"

namespace tumble {

SolverReport solve_interior_point(ContactProblem& problem, const SolverSettings& settings) {
  Ladder ladder(problem, settings);
  if (!ladder.solved()) ladder.interior_point(ladder.wanted());
  return ladder.finish();
}

}  // namespace tumble
