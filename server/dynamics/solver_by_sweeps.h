// What the sweeping solvers share: accept a warm start that is good enough, else sweep until the residual is below the
// tolerance, and choose the drift.
#pragma once

#include "dynamics/solver.h"
#include "dynamics/sweep.h"

namespace tumble {

/// `sweep_more(sweep, report)` goes over all contacts at least once, counts that in report.sweeps and returns the largest
/// correction [m/s].
template <typename SweepMore>
SolverReport solve_by_sweeps(ContactProblem& problem, const SolverSettings& settings, SweepMore sweep_more) {
  SolverReport report;
  apply_stored_impulses(problem);
  report.residual = compute_residual(problem);
  report.accepted = report.residual < settings.tolerance;
  if (!report.accepted) {
    Sweep sweep = make_sweep(problem);
    while (report.sweeps < settings.max_sweeps) {
      const double correction = sweep_more(sweep, report);
      // The corrections of a sweep come for free, but later visits disturb earlier ones: a small one is a reason to
      // measure, not to stop.
      if (correction >= settings.tolerance && report.sweeps < settings.max_sweeps) continue;
      update_impulses(sweep, problem);
      report.residual = compute_residual(problem);
      if (report.residual < settings.tolerance) break;
    }
  }
  problem.drift = choose_drift(problem);
  return report;
}

}  // namespace tumble
