// Warm-started projected Gauss-Seidel: sweeps over rows and contacts in their order, normal then friction disc, until
// the residual is below the tolerance. The velocities of the result are v* + M^-1 J^T lambda, computed once from the
// final impulses, so rounding does not collect over the sweeps and the residual speaks of exactly what is returned.
#include "dynamics/solver.h"
#include "dynamics/sweep.h"

namespace tumble {
namespace {

/// One pass; returns the largest correction [m/s].
double sweep_once(Sweep& sweep) {
  double largest = 0.0;
  for (SweptRow& row : sweep.rows) {
    largest = std::max(largest, visit_row(row, sweep.twists[row.a], sweep.twists[row.b]));
  }
  for (SweptContact& c : sweep.contacts) {
    Twist &A = sweep.twists[c.a], &B = sweep.twists[c.b];
    largest = std::max(largest, visit_normal(c, {.push = -c.bound}, A, B));
    largest = std::max(largest, visit_friction(c, A, B));
  }
  return largest;
}

void reset_velocities(const std::vector<Twist>& free, ContactProblem& problem) {
  for (std::size_t i = 0; i < free.size(); ++i) {
    problem.bodies[i].v = free[i].v;
    problem.bodies[i].w = free[i].w;
  }
}

}  // namespace

SolverReport solve_pgs(ContactProblem& problem, const SolverSettings& settings) {
  std::vector<Twist> free;
  free.reserve(problem.bodies.size());
  for (const SolverBody& body : problem.bodies) free.push_back({body.v, body.w});

  SolverReport report;
  apply_stored_impulses(problem);
  report.residual = compute_residual(problem);
  report.accepted = report.residual < settings.tolerance;
  if (!report.accepted) {
    Sweep sweep = make_sweep(problem);
    while (report.sweeps < settings.max_sweeps) {
      const double correction = sweep_once(sweep);
      ++report.sweeps;
      // The corrections of a sweep cost nothing and bound the residual from their own point of view only (later visits
      // disturb earlier ones), so a small one is a reason to measure, not to stop.
      const bool last = report.sweeps == settings.max_sweeps;
      if (!last && correction >= settings.tolerance) continue;
      store_impulses(sweep, problem);
      reset_velocities(free, problem);
      apply_stored_impulses(problem);
      report.residual = compute_residual(problem);
      if (report.residual < settings.tolerance) break;
    }
  }
  problem.drift = choose_drift(problem);
  return report;
}

}  // namespace tumble
