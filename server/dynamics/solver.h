// The ways to solve a ContactProblem: rivals in a file each, one signature, chosen by name.
#pragma once

#include <optional>
#include <string_view>

#include "dynamics/contact_problem.h"

namespace tumble {

enum class Solver {
  course_impulse,  ///< The slides: one contact at a time, fraction f of the unit impulse, positional correction.
  pgs,        ///< Warm-started projected Gauss-Seidel, friction disc, sweeps until the residual is small.
  nncg,       ///< The same sweeps, accelerated by conjugate gradients.
  soft_step,  ///< Sub-steps with soft contacts and a relax pass (TGS-soft).
  alm_newton,  ///< Newton on Coulomb's law from the warm start: to rounding in two or three steps, if it is near.
  interior_point,  ///< From a cold start: near the solution at any mass ratio, to rounding where nothing slides.
  exact,  ///< Warm start if good enough, else alm_newton, else interior_point and alm_newton: to rounding.
  automatic,  ///< exact for islands whose factorization is within `exact_work`, soft_step for the others.
};

struct SolverSettings {
  int max_sweeps = 30;  ///< pgs, nncg: upper limit of sweeps; course_impulse: passes over the contacts.
  /// [m/s] residual at which pgs and nncg stop, and at which they and the exact solvers accept a warm start unsolved. These
  /// solve to a tenth of it: 1e-10 by default, which costs Newton's method a step at most and lets what rolls keep 1e-9.
  double tolerance = 1e-9;
  int sub_steps = 4;                      ///< soft_step: at least so many in a step,
  double longest_sub_step = 1.0 / 960.0;  ///< [s] and none longer: overlaps grow with its square.
  /// automatic: largest work of a factorization, in products of 6 x 6 blocks, of an island that is solved exactly: as many
  /// times more as its heaviest body has the mass of its lightest, up to 18 times. A heap of 40 bodies is within it, as are
  /// chains and towers of hundreds. A larger one on the move takes 50 factorizations a step and is no better for it (./run
  /// bench error: heap, inelastic_666), unless much rests on little, which sub-steps do not carry.
  double exact_work = 100.0;
  /// automatic: as many times more for islands slower than exact_calm_speed [m/s, rad/s], which end in a few factorizations and
  /// then rest. A wall of 210 boxes is within it, a heap of 1000 bodies is not.
  double exact_calm_factor = 900.0;
  double exact_calm_speed = 0.1;
  /// automatic: what the factorizations of this island may take together, in the same products; where more is expected,
  /// soft_step's solution is taken.
  double work_left = kInfinity;
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]; the exact solvers tell implausible impulses by it.
};

struct SolverReport {
  int sweeps = 0;
  int newton_steps = 0;  ///< Factorizations of Newton's method.
  int iterations = 0;    ///< Factorizations of the interior point method.
  double work = 0.0;     ///< Of all of them, in products of 6 x 6 blocks.
  bool exact = false;    ///< The result is one of the exact solvers.
  bool fallback =
      false;  ///< exact found no trustworthy solution: what violates the conditions least was taken.
  double residual = 0.0;  ///< [m/s], by compute_residual on the result.
  bool accepted = false;  ///< The warm start was good as it was: nothing was solved.
};

/// In: prepared problem with v* and stored lambda. Out: end velocities, lambda, drift, shift and turn.
/// Momentum of the island is conserved to round-off.
SolverReport solve_course_impulse(ContactProblem& problem, const SolverSettings& settings);
SolverReport solve_pgs(ContactProblem& problem, const SolverSettings& settings);
SolverReport solve_nncg(ContactProblem& problem, const SolverSettings& settings);
SolverReport solve_soft_step(ContactProblem& problem, const SolverSettings& settings);
SolverReport solve_alm_newton(ContactProblem& problem, const SolverSettings& settings);
SolverReport solve_interior_point(ContactProblem& problem, const SolverSettings& settings);
SolverReport solve_exact(ContactProblem& problem, const SolverSettings& settings);
SolverReport solve_automatic(ContactProblem& problem, const SolverSettings& settings);

using SolveFunction = SolverReport (*)(ContactProblem&, const SolverSettings&);
SolveFunction solve_function(Solver solver);

/// Those of the law of contact to rounding: overlaps are removed apart from them (overlap.h), never by a velocity.
bool solves_exactly(Solver solver);

const char* solver_name(Solver solver);
std::optional<Solver> solver_from_name(std::string_view name);

}  // namespace tumble
