// The contact problem to rounding. Newton's method ends in two or three factorizations where the warm start is near;
// else the interior point brings the impulses near, whatever the mass ratio, and Newton ends it.
#include "dynamics/ladder.h"

namespace tumble {
namespace {

constexpr int kWarmSteps = 8;  // Newton ends in 2 to 5 or, from afar, hardly ever
constexpr int kPolishSteps = 12;
constexpr int kConeSteps = 25;  // heaps of 130 bodies: from 1e-4 to 1e-9..5e-7 m/s
constexpr int kPolishSweeps = 10;
/// [m/s] near enough for Newton: below it the interior point of sliding contacts stalls (1e-7 to 1e-3).
constexpr double kNearEnough = 1e-4;
/// [m/s] what a heap may be left with: it can rest on it.
constexpr double kFair = 1e-6;

}  // namespace

SolverReport finish_exactly(Ladder& ladder, const SolverSettings& settings, bool thorough) {
  if (!ladder.solved() && ladder.is_small()) ladder.sweep(settings.max_sweeps);
  if (!ladder.solved()) ladder.newton(kWarmSteps);
  if (!ladder.solved()) {
    const bool near = ladder.interior_point(kNearEnough);
    ladder.newton(kPolishSteps);
    if (near && thorough && !ladder.solved()) {
      ladder.cone_newton(kConeSteps);
      ladder.newton(kPolishSteps);
    }
    // Loads of 1e6 times a contact's own mass.
    if (near && thorough && ladder.residual() > kFair && !ladder.solved()) {
      ladder.interior_point(ladder.wanted());
      ladder.newton(kPolishSteps);
    }
  }
  if (!ladder.solved()) ladder.sweep(kPolishSweeps);
  // What is slow may come to rest on these impulses: they are worth a step more.
  if (!ladder.accepted() && ladder.start_speed() < settings.exact_calm_speed) ladder.newton(1);
  return ladder.finish();
}

SolverReport solve_exact(ContactProblem& problem, const SolverSettings& settings) {
  Ladder ladder(problem, settings);
  return finish_exactly(ladder, settings);
}

}  // namespace tumble
