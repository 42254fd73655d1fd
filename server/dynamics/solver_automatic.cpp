// The exact solver where its cost is bounded, sub-steps where it would not be. The choice is made from the work that a
// factorization of the island takes and from its speed, never from a clock, so it is the same on every machine. Both
// solvers store the impulses of whole steps, so an island may change between them and keep its warm start.
#include <algorithm>

#include "dynamics/ladder.h"

namespace tumble {
namespace {

/// Factorizations that an island takes which is not near its solution: 7 (a wall) to 40 (a heap).
constexpr double kExpected = 10.0;
/// As many times more work are heavy loads worth: a wall of 45 cubes under 200 times their mass.
constexpr double kMostForLoads = 18.0;
/// Bodies. In larger islands of equals on the move the last digits of what Newton does not solve cost more than all before
/// them, and serve nobody.
constexpr int kFew = 2;

}  // namespace

SolverReport solve_automatic(ContactProblem& problem, const SolverSettings& settings) {
  Ladder ladder(problem, settings);
  if (ladder.solved()) return finish_exactly(ladder, settings);
  const bool calm = ladder.start_speed() < settings.exact_calm_speed;
  const double loads = std::min(ladder.mass_ratio(), kMostForLoads);
  const double limit = settings.exact_work * (calm ? settings.exact_calm_factor : loads);
  if (!ladder.fits(static_cast<std::uint64_t>(limit)) || kExpected * ladder.work() > settings.work_left) {
    ladder.leave();
    return solve_soft_step(problem, settings);
  }
  return finish_exactly(ladder, settings, calm || loads == kMostForLoads || ladder.movable() <= kFew);
}

}  // namespace tumble
